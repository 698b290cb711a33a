"""How a store's database is made and brought up to date: one revision a file, by alembic.

A new revision is a new file in `versions`, with `down_revision` of the one before; then
`experiments.storage.tables` says what the database looks like now, and
`experiments.storage.database.SCHEMA` its number. A test compares the two.
"""
