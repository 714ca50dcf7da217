"""Routes of the journal."""

from dataclasses import asdict
from datetime import UTC, datetime
from typing import Annotated

from pydantic import Field
from sqlalchemy import Connection, func, insert, select

from app.answer import Answer, Count
from app.api.deps import ServicesDep
from app.api.fields import Body
from app.api.policy import OPERATOR, WATCH, api_router, policy
from app.api.record_response import RecordResponse
from app.storage.database.stored_rows import read_rows
from hexapods_journal.tables import ENTRIES

MAX_CHARS = 2_000


class EntryView(Answer):
    """An entry of the journal."""

    number: Count
    text: str
    written_at: datetime


class JournalView(Answer):
    """The entries, newest first."""

    items: list[EntryView]


class EntryBody(Body):
    """What is to be written down."""

    text: Annotated[str, Field(min_length=1, max_length=MAX_CHARS)]


router = api_router(prefix="/journal", tags=["journal"])


@router.get("", summary="Read the journal")
@policy(access=WATCH)
def read_journal(services: ServicesDep) -> RecordResponse[JournalView]:
    """Return all entries; a damaged one is left out, and logged."""
    rows = read_rows(services.store.database, ENTRIES, EntryView, ENTRIES.c.number.desc()).sound
    return RecordResponse(JournalView(items=rows))


@router.post("", status_code=201, summary="Write into the journal")
@policy(access=OPERATOR)
def write_entry(services: ServicesDep, body: EntryBody) -> RecordResponse[EntryView]:
    """Add an entry, which is durable once this is answered."""

    def work(connection: Connection) -> EntryView:
        last = connection.execute(select(func.max(ENTRIES.c.number))).scalar()
        entry = EntryView(
            number=1 if last is None else int(last) + 1,
            text=body.text,
            written_at=datetime.now(UTC),
        )
        connection.execute(insert(ENTRIES).values(asdict(entry)))
        return entry

    return RecordResponse(services.store.database.write(work), 201)
