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

from app.storage.database.columns import (
    JsonWithNan,
    PortableText,
    TagList,
    UtcTime,
    deletion_time,
)

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
    # Whether it ran elsewhere, as far as this server knows.
    Column("is_imported", Boolean, nullable=False, server_default=false()),
    Column("created_at", UtcTime, nullable=False),
    Column("started_at", UtcTime),
    Column("ended_at", UtcTime),
    deletion_time(),
    Index("ix_runs_kind_id", "kind", "id"),
    Index("ix_runs_kind_state_id", "kind", "state", "id"),
    Index("ix_runs_state_id", "state", "id"),
)

NON_FIELD_COLUMNS = (RUNS.c.distance_m, RUNS.c.is_imported, RUNS.c.deleted_at)
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

BASELINES = Table(
    "baselines",
    METADATA,
    # SHA-256 of the walking problem, world and software (`hexapods.runs.baseline`).
    Column("id", PortableText, primary_key=True),
    Column("distance_m", Double, nullable=False),
    Column("created_at", UtcTime, nullable=False),
    Index("ix_baselines_created_at", "created_at"),
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
    deletion_time(),
)
