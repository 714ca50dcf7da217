"""Revision demo_0001: runs of visitors."""

import sqlalchemy as sa
from alembic import op

revision = "demo_0001"
down_revision = None


def upgrade() -> None:
    """Create the table."""
    is_postgresql = op.get_bind().dialect.name == "postgresql"
    text = sa.String(collation="C" if is_postgresql else None)
    op.create_table(
        "visitor_runs",
        sa.Column("run_id", text, primary_key=True),
        sa.Column("visitor", text, nullable=False),
        sa.Column("steps", sa.BigInteger(), nullable=False),
        sa.Column("is_main", sa.Boolean(), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
    )
