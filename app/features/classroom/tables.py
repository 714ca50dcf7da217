"""Tables of lessons, and of rooms with their participants, predictions and runs."""

from sqlalchemy import BigInteger, Boolean, Column, ForeignKey, Index, MetaData, Table

from app.storage.database.columns import JsonWithNan, PortableText, UtcTime, deletion_time

METADATA = MetaData()

LESSONS = Table(
    "lessons",
    METADATA,
    Column("id", PortableText, primary_key=True),
    Column("title", PortableText, nullable=False),
    Column("document", JsonWithNan, nullable=False),
    Column("created_at", UtcTime, nullable=False),
    deletion_time(),
)

ROOMS = Table(
    "rooms",
    METADATA,
    Column("code", PortableText, primary_key=True),
    Column("lesson_id", PortableText),
    # A copy: a lesson that is deleted or changed stays as it is taught.
    Column("lesson", JsonWithNan, nullable=False),
    Column("card", BigInteger, nullable=False),
    Column("revealed", JsonWithNan, nullable=False),
    Column("is_frozen", Boolean, nullable=False),
    Column("needs_approval", Boolean, nullable=False),
    Column("spotlight", PortableText),
    Column("created_at", UtcTime, nullable=False),
    Column("ended_at", UtcTime),
)

PARTICIPANTS = Table(
    "participants",
    METADATA,
    Column("room", PortableText, ForeignKey("rooms.code", ondelete="CASCADE"), primary_key=True),
    Column("seed", BigInteger, primary_key=True, autoincrement=False),
    Column("name", PortableText, nullable=False),
    # As of sessions only the hash is stored.
    Column("key_sha256", PortableText, nullable=False, unique=True),
    Column("is_name_hidden", Boolean, nullable=False),
    Column("is_approved", Boolean, nullable=False),
    Column("joined_at", UtcTime, nullable=False),
    Column("left_at", UtcTime),
)

PREDICTIONS = Table(
    "predictions",
    METADATA,
    Column("room", PortableText, ForeignKey("rooms.code", ondelete="CASCADE"), primary_key=True),
    Column("seed", BigInteger, primary_key=True, autoincrement=False),
    Column("card", BigInteger, primary_key=True, autoincrement=False),
    Column("value", JsonWithNan, nullable=False),
    Column("made_at", UtcTime, nullable=False),
)

ROOM_RUNS = Table(
    "room_runs",
    METADATA,
    # No foreign key to runs: the link is written first, so that no run is ever without it.
    Column("run_id", PortableText, primary_key=True),
    Column("room", PortableText, ForeignKey("rooms.code", ondelete="CASCADE"), nullable=False),
    Column("seed", BigInteger, nullable=False),
    Column("card", BigInteger, nullable=False),
    # The settings that the participant gave.
    Column("given", JsonWithNan, nullable=False),
    # Whether it is the run that was asked for, not a training that it needs.
    Column("is_main", Boolean, nullable=False),
    # Whether others than the participant and operators may see it.
    Column("is_shown", Boolean, nullable=False),
    # Answer of a what-if; NULL for a run.
    Column("answer", JsonWithNan),
    Column("created_at", UtcTime, nullable=False),
    Index("ix_room_runs_room_card_seed", "room", "card", "seed"),
)
