"""The tables as this version knows them; `migrations` makes them, and brings older ones here."""

from sqlalchemy import BigInteger, Column, Double, ForeignKey, Index, MetaData, Table

from app.services.database.columns import Plain, UtcTime, Words

METADATA = MetaData()

ABOUT = Table(
    "about",
    METADATA,
    # The one row names the folder of this database's files, so that no other database's server
    # takes them for nobody's.
    Column("id", Words, primary_key=True),
)

RUNS = Table(
    "runs",
    METADATA,
    Column("id", Words, primary_key=True),
    Column("kind", Words, nullable=False),
    Column("name", Words, nullable=False),
    Column("state", Words, nullable=False),
    Column("config", Plain, nullable=False),
    Column("lane_training_ids", Plain, nullable=False),
    Column("waiting_for", Plain, nullable=False),
    Column("continued_from", Words),
    Column("workers", BigInteger),
    Column("done", BigInteger, nullable=False),
    Column("total", BigInteger, nullable=False),
    Column("eta_s", Double),
    Column("changes", Plain, nullable=False),
    Column("greedy_distance_m", Double),
    Column("result", Plain),
    Column("error", Words),
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
    Column("run_id", Words, ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True),
    Column("step", BigInteger, primary_key=True, autoincrement=False),
    # NULL is NaN: SQLite knows no other.
    Column("distance_m", Double),
    Column("epsilon", Double),
)

TRIALS = Table(
    "trials",
    METADATA,
    Column("run_id", Words, ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True),
    Column("key", Words, primary_key=True),
    Column("result", Plain),
    Column("set_aside", Words),
    Column("compute_s", Double, nullable=False),
)

ARTIFACTS = Table(
    "artifacts",
    METADATA,
    Column("run_id", Words, ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True),
    Column("name", Words, primary_key=True),
    Column("file", Words, nullable=False, unique=True),
    Column("size", BigInteger, nullable=False),
    Column("sha256", Words, nullable=False),
    Column("written_at", UtcTime, nullable=False),
)
