"""Revision tournaments_0001: tournaments with entries, judgements and tables."""

import sqlalchemy as sa
from alembic import op

revision = "tournaments_0001"
down_revision = None


def upgrade() -> None:
    """Create the tables."""
    is_postgresql = op.get_bind().dialect.name == "postgresql"
    text = sa.String(collation="C" if is_postgresql else None)
    time = sa.DateTime(timezone=True)
    op.create_table(
        "tournaments",
        sa.Column("id", text, primary_key=True),
        sa.Column("title", text, nullable=False),
        sa.Column("room", text),
        sa.Column("rules", sa.JSON(), nullable=False),
        sa.Column("secret", text, nullable=False),
        sa.Column("entries_per_hour", sa.BigInteger(), nullable=False),
        sa.Column("state", text, nullable=False),
        sa.Column("outcome", sa.JSON()),
        sa.Column("created_at", time, nullable=False),
        sa.Column("ended_at", time),
    )

    def tournament() -> sa.Column[str]:
        key = sa.ForeignKey("tournaments.id", ondelete="CASCADE")
        return sa.Column("tournament", text, key, primary_key=True)

    def number(name: str) -> sa.Column[int]:
        return sa.Column(name, sa.BigInteger(), primary_key=True, autoincrement=False)

    op.create_table(
        "tournament_entries",
        tournament(),
        number("number"),
        sa.Column("seed", sa.BigInteger()),
        sa.Column("name", text, nullable=False),
        sa.Column("is_reference", sa.Boolean(), nullable=False),
        sa.Column("entry", sa.JSON(), nullable=False),
        sa.Column("training_id", text),
        sa.Column("is_withdrawn", sa.Boolean(), nullable=False),
        sa.Column("entered_at", time, nullable=False),
    )
    op.create_table(
        "tournament_judgements",
        tournament(),
        number("number"),
        number("draw"),
        sa.Column("distance_m", sa.Double(), nullable=False),
        sa.Column("failure", text),
    )
    op.create_table(
        "tournament_tables",
        tournament(),
        sa.Column("sha256", text, primary_key=True),
        sa.Column("data", text, nullable=False),
    )
