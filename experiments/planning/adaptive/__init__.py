"""Designs in which the answers so far decide what is shown next."""
