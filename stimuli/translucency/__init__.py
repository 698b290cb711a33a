"""The dipole: measured media, the sum over a surface, and the pictures of translucent bodies."""
