"""The table of the journal."""

from sqlalchemy import BigInteger, Column, MetaData, Table

from app.storage.database.columns import PortableText, UtcTime

METADATA = MetaData()

ENTRIES = Table(
    "journal_entries",
    METADATA,
    Column("number", BigInteger, primary_key=True, autoincrement=False),
    Column("text", PortableText, nullable=False),
    Column("written_at", UtcTime, nullable=False),
)
