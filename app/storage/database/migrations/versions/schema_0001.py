"""Schema 0001: runs, their curves and their artifacts."""

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None


def upgrade() -> None:
    """Create the first tables."""
    # Column types are spelled out, so that later changes of the app do not alter this schema.
    is_postgresql = op.get_bind().dialect.name == "postgresql"
    text = sa.String(collation="C" if is_postgresql else None)
    time = sa.DateTime(timezone=True)
    op.create_table("about", sa.Column("id", text, primary_key=True))
    op.create_table(
        "runs",
        sa.Column("id", text, primary_key=True),
        sa.Column("kind", text, nullable=False),
        sa.Column("name", text, nullable=False),
        sa.Column("state", text, nullable=False),
        sa.Column("config", sa.JSON(), nullable=False),
        sa.Column("lane_training_ids", sa.JSON(), nullable=False),
        sa.Column("waiting_for", sa.JSON(), nullable=False),
        sa.Column("continued_from", text),
        sa.Column("done", sa.BigInteger(), nullable=False),
        sa.Column("total", sa.BigInteger(), nullable=False),
        sa.Column("eta_s", sa.Double()),
        sa.Column("changes", sa.JSON(), nullable=False),
        sa.Column("greedy_distance_m", sa.Double()),
        sa.Column("result", sa.JSON()),
        sa.Column("error", text),
        sa.Column("created_at", time, nullable=False),
        sa.Column("started_at", time),
        sa.Column("ended_at", time),
    )
    op.create_index("ix_runs_kind_id", "runs", ["kind", "id"])
    op.create_index("ix_runs_kind_state_id", "runs", ["kind", "state", "id"])
    op.create_index("ix_runs_state_id", "runs", ["state", "id"])
    of_run = "runs.id"
    op.create_table(
        "evaluations",
        sa.Column("run_id", text, sa.ForeignKey(of_run, ondelete="CASCADE"), primary_key=True),
        sa.Column("step", sa.BigInteger(), primary_key=True, autoincrement=False),
        sa.Column("distance_m", sa.Double()),
        sa.Column("epsilon", sa.Double()),
    )
    op.create_table(
        "artifacts",
        sa.Column("run_id", text, sa.ForeignKey(of_run, ondelete="CASCADE"), primary_key=True),
        sa.Column("name", text, primary_key=True),
        sa.Column("file", text, nullable=False, unique=True),
        sa.Column("size", sa.BigInteger(), nullable=False),
        sa.Column("sha256", text, nullable=False),
        sa.Column("written_at", time, nullable=False),
    )
