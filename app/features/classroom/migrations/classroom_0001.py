"""Revision classroom_0001: lessons, and rooms with their participants, predictions and runs."""

import sqlalchemy as sa
from alembic import op

revision = "classroom_0001"
down_revision = None


def upgrade() -> None:
    """Create the tables."""
    is_postgresql = op.get_bind().dialect.name == "postgresql"
    text = sa.String(collation="C" if is_postgresql else None)
    time = sa.DateTime(timezone=True)
    op.create_table(
        "lessons",
        sa.Column("id", text, primary_key=True),
        sa.Column("title", text, nullable=False),
        sa.Column("document", sa.JSON(), nullable=False),
        sa.Column("created_at", time, nullable=False),
    )
    op.create_table(
        "rooms",
        sa.Column("code", text, primary_key=True),
        sa.Column("lesson_id", text),
        sa.Column("lesson", sa.JSON(), nullable=False),
        sa.Column("card", sa.BigInteger(), nullable=False),
        sa.Column("revealed", sa.JSON(), nullable=False),
        sa.Column("is_frozen", sa.Boolean(), nullable=False),
        sa.Column("needs_approval", sa.Boolean(), nullable=False),
        sa.Column("spotlight", text),
        sa.Column("created_at", time, nullable=False),
        sa.Column("ended_at", time),
    )

    def room() -> sa.ForeignKey:
        return sa.ForeignKey("rooms.code", ondelete="CASCADE")

    def number(name: str) -> sa.Column[int]:
        return sa.Column(name, sa.BigInteger(), primary_key=True, autoincrement=False)

    op.create_table(
        "participants",
        sa.Column("room", text, room(), primary_key=True),
        number("seed"),
        sa.Column("name", text, nullable=False),
        sa.Column("key_sha256", text, nullable=False, unique=True),
        sa.Column("is_name_hidden", sa.Boolean(), nullable=False),
        sa.Column("is_approved", sa.Boolean(), nullable=False),
        sa.Column("joined_at", time, nullable=False),
        sa.Column("left_at", time),
    )
    op.create_table(
        "predictions",
        sa.Column("room", text, room(), primary_key=True),
        number("seed"),
        number("card"),
        sa.Column("value", sa.JSON(), nullable=False),
        sa.Column("made_at", time, nullable=False),
    )
    op.create_table(
        "room_runs",
        sa.Column("run_id", text, primary_key=True),
        sa.Column("room", text, room(), nullable=False),
        sa.Column("seed", sa.BigInteger(), nullable=False),
        sa.Column("card", sa.BigInteger(), nullable=False),
        sa.Column("given", sa.JSON(), nullable=False),
        sa.Column("is_main", sa.Boolean(), nullable=False),
        sa.Column("is_shown", sa.Boolean(), nullable=False),
        sa.Column("answer", sa.JSON(none_as_null=True)),
        sa.Column("created_at", time, nullable=False),
    )
    op.create_index("ix_room_runs_room_card_seed", "room_runs", ["room", "card", "seed"])
