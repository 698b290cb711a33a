"""Objects on grey, each under a key light of its own: arrangement, materials, rendering."""
