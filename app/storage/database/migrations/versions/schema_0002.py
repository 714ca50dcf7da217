"""Schema 0002: trials of experiments, and the number of workers of a run."""

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"


def upgrade() -> None:
    """Add what experiments need; existing rows are unchanged."""
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
