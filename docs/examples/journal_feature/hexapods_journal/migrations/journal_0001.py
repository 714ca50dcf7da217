"""Revision journal_0001: the entries."""

import sqlalchemy as sa
from alembic import op

revision = "journal_0001"
down_revision = None


def upgrade() -> None:
    """Create the table."""
    is_postgresql = op.get_bind().dialect.name == "postgresql"
    op.create_table(
        "journal_entries",
        sa.Column("number", sa.BigInteger(), primary_key=True, autoincrement=False),
        sa.Column("text", sa.String(collation="C" if is_postgresql else None), nullable=False),
        sa.Column("written_at", sa.DateTime(timezone=True), nullable=False),
    )
