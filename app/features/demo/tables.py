"""Tables of the runs of a demo's visitors."""

from sqlalchemy import BigInteger, Boolean, Column, MetaData, Table

from app.storage.database.columns import PortableText, UtcTime

METADATA = MetaData()

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
