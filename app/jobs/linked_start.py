"""A start whose runs are noted as someone's before they are stored."""

from collections.abc import Callable, Sequence

from app.jobs.submissions import Start
from app.storage.database.store import RunStore
from app.storage.run import Run


class LinkedStart:
    """A start that tells of its runs before they are stored, so that none is ever without its link.

    Attributes:
        links: ids of the runs that were told of.
    """

    def __init__(self, start: Start, link: Callable[[Sequence[Run]], None]) -> None:
        """Wrap a start.

        Args:
            start: makes the runs.
            link: called with them; what it raises refuses the start.
        """
        self._start, self._link = start, link
        self.links: tuple[str, ...] = ()

    def runs(self, store: RunStore, new_id: Callable[[], str]) -> list[Run]:
        """See `Start`."""
        runs = self._start.runs(store, new_id)
        self._link(runs)
        self.links = tuple(run.id for run in runs)
        return runs
