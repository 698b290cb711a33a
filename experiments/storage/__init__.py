"""What is kept of a study and of who takes part: append-only rows in SQLite or PostgreSQL."""
