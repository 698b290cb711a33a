"""Edits of picture files: each reads its inputs, and leaves the picture and a record beside it."""
