"""Experiments: their trials, and how many workers they have."""

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"


def upgrade() -> None:
    """Make room for experiments; what is there stays as it is."""
    is_postgresql = op.get_bind().dialect.name == "postgresql"
    text = sa.String(collation="C" if is_postgresql else None)
    op.add_column("runs", sa.Column("workers", sa.BigInteger()))
    op.create_table(
        "trials",
        sa.Column("run_id", text, sa.ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True),
        sa.Column("key", text, primary_key=True),
        sa.Column("result", sa.JSON()),
        sa.Column("set_aside", text),
        sa.Column("compute_s", sa.Double(), nullable=False),
    )
