"""Runs the revisions within the transaction that `experiments.storage.database` has opened."""

from alembic import context

from experiments.storage.tables import metadata

context.configure(
    connection=context.config.attributes["connection"],
    target_metadata=metadata,
    transactional_ddl=True,
)
with context.begin_transaction():
    context.run_migrations()
