"""Response models of the demo, as those of `app.api.answers`."""

from datetime import datetime

from app.answer import Answer, Count


class AllowanceView(Answer):
    """What each visitor of a demo may start, and what is left of it to who asks.

    Attributes:
        steps_per_hour: steps that may be computed in any hour; of a race of all its lanes.
        steps_left: of these.
        steps_per_start: steps of one start, with all the practice that a race needs.
        least_steps: a start counts as so many at least.
        max_unended: starts that may wait or go on at once.
        unended: starts that do.
        max_kept: runs that may be kept at once.
        seconds_per_run: for so long a run computes at most; then it is stopped [s].
        hours: after how many hours what was made is deleted.
        runs: ids of the runs of who asks, oldest first.
    """

    steps_per_hour: Count
    steps_left: Count
    steps_per_start: Count
    least_steps: Count
    max_unended: Count
    unended: Count
    max_kept: Count
    seconds_per_run: float
    hours: Count
    runs: list[str]


class VisitorView(Answer):
    """A visitor of a demo, of whom nothing but this is known.

    Attributes:
        id: beginning of the hash of the key in the visitor's cookie.
        since: when the oldest of the runs was made.
        newest: when the newest was.
        steps: that were started within the hour before that.
        runs: ids of the runs, oldest first; some may have been deleted.
    """

    id: str
    since: datetime
    newest: datetime
    steps: Count
    runs: list[str]


class VisitorList(Answer):
    """The visitors of a demo, those who have started last first."""

    items: list[VisitorView]
