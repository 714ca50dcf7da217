"""Revision core_0001: runs with curves and artifacts, baselines, keys, sessions and robots."""

import sqlalchemy as sa
from alembic import op

revision = "core_0001"
down_revision = None


def upgrade() -> None:
    """Create the tables."""
    # Column types are spelled out, so that later changes of the app do not alter this schema.
    is_postgresql = op.get_bind().dialect.name == "postgresql"
    text = sa.String(collation="C" if is_postgresql else None)
    time = sa.DateTime(timezone=True)
    op.create_table(
        "about",
        sa.Column("id", text, primary_key=True),
        sa.Column("owner", sa.BigInteger(), nullable=False, server_default="0"),
    )
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
        sa.Column("workers", sa.BigInteger()),
        sa.Column("done", sa.BigInteger(), nullable=False),
        sa.Column("total", sa.BigInteger(), nullable=False),
        sa.Column("eta_s", sa.Double()),
        sa.Column("changes", sa.JSON(), nullable=False),
        sa.Column("greedy_distance_m", sa.Double()),
        sa.Column("result", sa.JSON()),
        sa.Column("error", text),
        sa.Column("tags", text, nullable=False, server_default=""),
        sa.Column("notes", text, nullable=False, server_default=""),
        sa.Column("distance_m", sa.Double()),
        sa.Column("is_imported", sa.Boolean(), nullable=False, server_default=sa.false()),
        sa.Column("created_at", time, nullable=False),
        sa.Column("started_at", time),
        sa.Column("ended_at", time),
    )
    op.create_index("ix_runs_kind_id", "runs", ["kind", "id"])
    op.create_index("ix_runs_kind_state_id", "runs", ["kind", "state", "id"])
    op.create_index("ix_runs_state_id", "runs", ["state", "id"])
    run = "runs.id"
    op.create_table(
        "evaluations",
        sa.Column("run_id", text, sa.ForeignKey(run, ondelete="CASCADE"), primary_key=True),
        sa.Column("step", sa.BigInteger(), primary_key=True, autoincrement=False),
        sa.Column("distance_m", sa.Double()),
        sa.Column("epsilon", sa.Double()),
    )
    op.create_table(
        "artifacts",
        sa.Column("run_id", text, sa.ForeignKey(run, ondelete="CASCADE"), primary_key=True),
        sa.Column("name", text, primary_key=True),
        sa.Column("file", text, nullable=False, unique=True),
        sa.Column("size", sa.BigInteger(), nullable=False),
        sa.Column("sha256", text, nullable=False),
        sa.Column("written_at", time, nullable=False),
    )
    op.create_table(
        "baselines",
        sa.Column("id", text, primary_key=True),
        sa.Column("distance_m", sa.Double(), nullable=False),
        sa.Column("created_at", time, nullable=False),
    )
    op.create_index("ix_baselines_created_at", "baselines", ["created_at"])
    op.create_table(
        "idempotency_keys",
        sa.Column("key", text, primary_key=True),
        sa.Column("digest", text, nullable=False),
        sa.Column("run_id", text, nullable=False),
        sa.Column("created_at", time, nullable=False),
    )
    op.create_index("ix_idempotency_keys_created_at", "idempotency_keys", ["created_at"])
    op.create_table(
        "sessions",
        sa.Column("id_sha256", text, primary_key=True),
        sa.Column("token_sha256", text, nullable=False),
        sa.Column("created_at", time, nullable=False),
        sa.Column("expires_at", time, nullable=False),
    )
    op.create_index("ix_sessions_expires_at", "sessions", ["expires_at"])
    op.create_table(
        "robots",
        sa.Column("id", text, primary_key=True),
        sa.Column("name", text, nullable=False),
        sa.Column("hidden", sa.BigInteger(), nullable=False, server_default="0"),
        sa.Column("gait", sa.JSON(none_as_null=True)),
        sa.Column("guesses", sa.JSON(), nullable=False),
        sa.Column("repairs", sa.JSON(), nullable=False),
        sa.Column("choices", sa.JSON(none_as_null=True)),
        sa.Column("file", text),
        sa.Column("created_at", time, nullable=False),
    )
