"""Alembic's environment script: runs migrations on a connection with an open transaction."""

from alembic import context

from app.storage.database.migration import CONNECTION, VERSION_TABLE

context.configure(
    connection=context.config.attributes[CONNECTION],
    version_table=context.config.attributes.get(VERSION_TABLE, "alembic_version"),
    # SQLite lacks most of ALTER TABLE: batch mode copies the table instead.
    render_as_batch=True,
)
with context.begin_transaction():
    context.run_migrations()
