"""What Alembic runs to migrate, with a connection whose transaction is already open."""

from alembic import context

from app.storage.database.migration import CONNECTION

context.configure(
    connection=context.config.attributes[CONNECTION],
    # SQLite changes a table by copying it.
    render_as_batch=True,
)
with context.begin_transaction():
    context.run_migrations()
