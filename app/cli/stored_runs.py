"""Functions of the commands that read runs from a data folder."""

from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import TYPE_CHECKING

from app.settings import Settings
from app.storage.errors import NotFound
from app.storage.run import AnyRun
from hexapods.domain.errors import InvalidInput

if TYPE_CHECKING:
    from app.storage.database.store import RunStore


def find_run(store: "RunStore", run_id: str) -> AnyRun:
    """Return a run, or what can be read of a damaged one.

    Raises:
        InvalidInput: if there is no such run.
    """
    try:
        return store.find(run_id)
    except NotFound as error:
        raise InvalidInput(f"{error}; `hexapods runs list` shows what there is") from error


def open_for_reading(settings: Settings) -> "AbstractContextManager[RunStore]":
    """Open the store of a data folder read-only."""
    # Imported here, as the database modules would slow the start of other commands.
    from app.storage.database.read_only import open_read_only  # noqa: PLC0415

    return open_read_only(settings)


@contextmanager
def open_for_writing(settings: Settings) -> "Iterator[RunStore]":
    """Open the store of a data folder as a server would, with the tables of features.

    Raises:
        FolderInUse: if a server has the data folder.
        HexapodError: as `app.storage.database.opening.open_store` and `migrate_tables`.
    """
    # Imported here, as above.
    from app.active_features import migrate_tables  # noqa: PLC0415
    from app.installed_features import load  # noqa: PLC0415
    from app.storage.database.opening import open_store  # noqa: PLC0415

    with open_store(settings) as store:
        migrate_tables(load(settings.without).classes, store.database)
        yield store
