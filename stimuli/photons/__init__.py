"""The photon mapper: from lights through glass to matt surfaces, and the pictures of that."""
