"""Schema 0003: fencing token, idempotency keys and operators' sessions."""

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"


def upgrade() -> None:
    """Add what used to be in memory only; existing rows are unchanged."""
    is_postgresql = op.get_bind().dialect.name == "postgresql"
    text = sa.String(collation="C" if is_postgresql else None)
    time = sa.DateTime(timezone=True)
    op.add_column("about", sa.Column("owner", sa.BigInteger(), nullable=False, server_default="0"))
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
