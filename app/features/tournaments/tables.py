"""Tables of tournaments, their entries, judgements and tables of values."""

from sqlalchemy import BigInteger, Boolean, Column, Double, ForeignKey, MetaData, Table

from app.storage.database.columns import JsonWithNan, PortableText, UtcTime, deletion_time

METADATA = MetaData()

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
    deletion_time(),
)


def _of_tournament() -> ForeignKey:
    return ForeignKey("tournaments.id", ondelete="CASCADE")


TOURNAMENT_ENTRIES = Table(
    "tournament_entries",
    METADATA,
    Column("tournament", PortableText, _of_tournament(), primary_key=True),
    Column("number", BigInteger, primary_key=True, autoincrement=False),
    # Seed of the participant who entered it; NULL for references, and entries of operators.
    Column("seed", BigInteger),
    # Name of a reference, or the name that an operator has entered.
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
