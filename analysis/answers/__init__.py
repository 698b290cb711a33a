"""Answers as tables: joined with what was shown, and whose of them count."""
