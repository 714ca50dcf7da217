"""Alembic's environment script: runs migrations on a connection with an open transaction."""

from alembic import context

from app.storage.database.migration import CONNECTION

context.configure(
    connection=context.config.attributes[CONNECTION],
    # SQLite lacks most of ALTER TABLE: batch mode copies the table instead.
    render_as_batch=True,
)
with context.begin_transaction():
    context.run_migrations()
