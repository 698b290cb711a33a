"""Meshes: procedural families, figures and vessels, files of the user, and their measures."""
