"""Revision experiments_0001: trials."""

import sqlalchemy as sa
from alembic import op

revision = "experiments_0001"
down_revision = None


def upgrade() -> None:
    """Create the table."""
    is_postgresql = op.get_bind().dialect.name == "postgresql"
    text = sa.String(collation="C" if is_postgresql else None)
    run = sa.ForeignKey("runs.id", ondelete="CASCADE")
    op.create_table(
        "trials",
        sa.Column("run_id", text, run, primary_key=True),
        sa.Column("key", text, primary_key=True),
        sa.Column("result", sa.JSON()),
        sa.Column("set_aside", text),
        sa.Column("compute_s", sa.Double(), nullable=False),
    )
