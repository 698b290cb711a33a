"""Judgements: which of two is preferred, and whether an image is taken for real."""
