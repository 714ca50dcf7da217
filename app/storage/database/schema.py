"""Table definitions of this version's schema; `migrations` creates and upgrades them."""

from sqlalchemy import (
    BigInteger,
    Boolean,
    Column,
    Double,
    ForeignKey,
    Index,
    MetaData,
    Table,
    false,
)

from app.storage.database.columns import JsonWithNan, PortableText, TagList, UtcTime

METADATA = MetaData()

ABOUT = Table(
    "about",
    METADATA,
    # Id of the database (one row); names the folder of its artifact files, so that a server with
    # another database does not delete them as orphans.
    Column("id", PortableText, primary_key=True),
    # Fencing token: incremented by every server that claims the database, checked by every write.
    Column("owner", BigInteger, nullable=False, server_default="0"),
)

RUNS = Table(
    "runs",
    METADATA,
    Column("id", PortableText, primary_key=True),
    Column("kind", PortableText, nullable=False),
    Column("name", PortableText, nullable=False),
    Column("state", PortableText, nullable=False),
    Column("config", JsonWithNan, nullable=False),
    Column("lane_training_ids", JsonWithNan, nullable=False),
    Column("waiting_for", JsonWithNan, nullable=False),
    Column("continued_from", PortableText),
    Column("workers", BigInteger),
    Column("done", BigInteger, nullable=False),
    Column("total", BigInteger, nullable=False),
    Column("eta_s", Double),
    Column("changes", JsonWithNan, nullable=False),
    Column("greedy_distance_m", Double),
    Column("result", JsonWithNan),
    Column("error", PortableText),
    Column("tags", TagList, nullable=False, server_default=""),
    Column("notes", PortableText, nullable=False, server_default=""),
    # Derived from the result, for sorting; NULL where there is none.
    Column("distance_m", Double),
    # Whether it ran elsewhere, as far as this server knows: since 0008.
    Column("is_imported", Boolean, nullable=False, server_default=false()),
    Column("created_at", UtcTime, nullable=False),
    Column("started_at", UtcTime),
    Column("ended_at", UtcTime),
    Index("ix_runs_kind_id", "kind", "id"),
    Index("ix_runs_kind_state_id", "kind", "state", "id"),
    Index("ix_runs_state_id", "state", "id"),
)

BESIDE = (RUNS.c.distance_m, RUNS.c.is_imported)
"""Columns that are no fields of a run."""

EVALUATIONS = Table(
    "evaluations",
    METADATA,
    Column("run_id", PortableText, ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True),
    Column("step", BigInteger, primary_key=True, autoincrement=False),
    # NULL stands for NaN, which SQLite cannot store.
    Column("distance_m", Double),
    Column("epsilon", Double),
)

TRIALS = Table(
    "trials",
    METADATA,
    Column("run_id", PortableText, ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True),
    Column("key", PortableText, primary_key=True),
    Column("result", JsonWithNan),
    Column("set_aside", PortableText),
    Column("compute_s", Double, nullable=False),
)

ARTIFACTS = Table(
    "artifacts",
    METADATA,
    Column("run_id", PortableText, ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True),
    Column("name", PortableText, primary_key=True),
    Column("file", PortableText, nullable=False, unique=True),
    Column("size", BigInteger, nullable=False),
    Column("sha256", PortableText, nullable=False),
    Column("written_at", UtcTime, nullable=False),
)

IDEMPOTENCY_KEYS = Table(
    "idempotency_keys",
    METADATA,
    Column("key", PortableText, primary_key=True),
    # SHA-256 of the request, to reject a key that is reused with another request.
    Column("digest", PortableText, nullable=False),
    # No foreign key: the key must outlive its run, or a retry would start a deleted run again.
    Column("run_id", PortableText, nullable=False),
    Column("created_at", UtcTime, nullable=False),
    Index("ix_idempotency_keys_created_at", "created_at"),
)

SESSIONS = Table(
    "sessions",
    METADATA,
    # Only hashes are stored, so that read access to the database does not give away sessions.
    Column("id_sha256", PortableText, primary_key=True),
    # Sessions are valid only with the access token that opened them.
    Column("token_sha256", PortableText, nullable=False),
    Column("created_at", UtcTime, nullable=False),
    Column("expires_at", UtcTime, nullable=False),
    Index("ix_sessions_expires_at", "expires_at"),
)

LESSONS = Table(
    "lessons",
    METADATA,
    Column("id", PortableText, primary_key=True),
    Column("title", PortableText, nullable=False),
    Column("document", JsonWithNan, nullable=False),
    Column("created_at", UtcTime, nullable=False),
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
    # What a what-if gave; of a run none.
    Column("answer", JsonWithNan),
    Column("created_at", UtcTime, nullable=False),
    Index("ix_room_runs_room_card_seed", "room", "card", "seed"),
)

TOURNAMENTS = Table(
    "tournaments",
    METADATA,
    Column("id", PortableText, primary_key=True),
    Column("title", PortableText, nullable=False),
    # Code of its room. No foreign key: a tournament stays what it is without it.
    Column("room", PortableText),
    Column("rules", JsonWithNan, nullable=False),
    # From which the draws follow; nobody reads it before the end.
    Column("secret", PortableText, nullable=False),
    Column("entries_per_hour", BigInteger, nullable=False),
    Column("state", PortableText, nullable=False),
    # Once it has ended: its standings, and by what and where they were computed.
    Column("outcome", JsonWithNan),
    Column("created_at", UtcTime, nullable=False),
    Column("ended_at", UtcTime),
)


def _of_tournament() -> ForeignKey:
    return ForeignKey("tournaments.id", ondelete="CASCADE")


TOURNAMENT_ENTRIES = Table(
    "tournament_entries",
    METADATA,
    Column("tournament", PortableText, _of_tournament(), primary_key=True),
    Column("number", BigInteger, primary_key=True, autoincrement=False),
    # Of the participant who entered it; NULL for references, and entries of operators.
    Column("seed", BigInteger),
    # Of a reference, or as an operator has given it.
    Column("name", PortableText, nullable=False),
    Column("is_reference", Boolean, nullable=False),
    Column("entry", JsonWithNan, nullable=False),
    Column("training_id", PortableText),
    Column("is_withdrawn", Boolean, nullable=False),
    Column("entered_at", UtcTime, nullable=False),
)

TOURNAMENT_JUDGEMENTS = Table(
    "tournament_judgements",
    METADATA,
    Column("tournament", PortableText, _of_tournament(), primary_key=True),
    Column("number", BigInteger, primary_key=True, autoincrement=False),
    Column("draw", BigInteger, primary_key=True, autoincrement=False),
    Column("distance_m", Double, nullable=False),
    Column("failure", PortableText),
)

TOURNAMENT_TABLES = Table(
    "tournament_tables",
    METADATA,
    # Copies, so that they stay when their trainings are deleted.
    Column("tournament", PortableText, _of_tournament(), primary_key=True),
    Column("sha256", PortableText, primary_key=True),
    # In base64, as in the file of the tournament.
    Column("data", PortableText, nullable=False),
)

VISITOR_RUNS = Table(
    "visitor_runs",
    METADATA,
    # No foreign key to runs: the link is written first, and counts after its run was deleted.
    Column("run_id", PortableText, primary_key=True),
    # SHA-256 of the key in the visitor's cookie; nothing else is known of who it is.
    Column("visitor", PortableText, nullable=False),
    Column("steps", BigInteger, nullable=False),
    # Whether it is the run that was asked for, not a training that it needs.
    Column("is_main", Boolean, nullable=False),
    Column("created_at", UtcTime, nullable=False),
)

ROBOTS = Table(
    "robots",
    METADATA,
    # Beginning of the SHA-256 of its document, which is a file.
    Column("id", PortableText, primary_key=True),
    Column("name", PortableText, nullable=False),
    Column("hidden", BigInteger, nullable=False, server_default="0"),
    Column("gait", JsonWithNan),
    Column("guesses", JsonWithNan, nullable=False),
    Column("repairs", JsonWithNan, nullable=False),
    Column("choices", JsonWithNan),
    Column("file", PortableText),
    Column("created_at", UtcTime, nullable=False),
)
