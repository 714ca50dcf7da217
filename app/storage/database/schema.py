"""The tables as this version knows them; `migrations` makes them, and brings older ones here."""

from sqlalchemy import BigInteger, Column, Double, ForeignKey, Index, MetaData, Table

from app.storage.database.columns import JsonWithNan, PortableText, UtcTime

METADATA = MetaData()

ABOUT = Table(
    "about",
    METADATA,
    # The one row names the folder of this database's files, so that no other database's server
    # takes them for nobody's.
    Column("id", PortableText, primary_key=True),
    # Fencing token: rises with every server that opens the database, and every write checks it.
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
    Column("created_at", UtcTime, nullable=False),
    Column("started_at", UtcTime),
    Column("ended_at", UtcTime),
    Index("ix_runs_kind_id", "kind", "id"),
    Index("ix_runs_kind_state_id", "kind", "state", "id"),
    Index("ix_runs_state_id", "state", "id"),
)

EVALUATIONS = Table(
    "evaluations",
    METADATA,
    Column("run_id", PortableText, ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True),
    Column("step", BigInteger, primary_key=True, autoincrement=False),
    # NULL is NaN: SQLite knows no other.
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
    # SHA-256 of the request, so that a key is not taken for another one.
    Column("digest", PortableText, nullable=False),
    # No foreign key: a run that was deleted was started all the same.
    Column("run_id", PortableText, nullable=False),
    Column("created_at", UtcTime, nullable=False),
    Index("ix_idempotency_keys_created_at", "created_at"),
)

SESSIONS = Table(
    "sessions",
    METADATA,
    # Hashes only: whoever reads the database cannot become an operator by it.
    Column("id_sha256", PortableText, primary_key=True),
    # A server with another token knows none of the sessions of this one.
    Column("token_sha256", PortableText, nullable=False),
    Column("created_at", UtcTime, nullable=False),
    Column("expires_at", UtcTime, nullable=False),
    Index("ix_sessions_expires_at", "expires_at"),
)
