"""The table of the trials of experiments."""

from sqlalchemy import Column, Double, ForeignKey, MetaData, Table

from app.storage.database.columns import JsonWithNan, PortableText
from app.storage.database.schema import RUNS

METADATA = MetaData()

TRIALS = Table(
    "trials",
    METADATA,
    Column("run_id", PortableText, ForeignKey(RUNS.c.id, ondelete="CASCADE"), primary_key=True),
    Column("key", PortableText, primary_key=True),
    Column("result", JsonWithNan),
    Column("set_aside", PortableText),
    Column("compute_s", Double, nullable=False),
)
