"""Chooses the recorded runs that a stage shows by itself: after a start, and as a replay."""

from datetime import datetime, timedelta

from app.storage.database.store import RunStore
from app.storage.recordings import Recordings
from app.storage.run import Run
from app.storage.run_kind import WALKS
from hexapods.domain.errors import HexapodError

_RECENT_RUNS = 20
"""Runs among which is chosen."""
_SAME_END = timedelta(seconds=15)
"""Time within which all runs end that the end of a server interrupts."""


def run_of_last_work(store: RunStore, recordings: Recordings) -> Run | None:
    """Return the run that was last at work; None without one.

    Of those that the end of the server has interrupted one that is recorded, if any is.
    """
    newest = store.list(limit=_RECENT_RUNS, condition=store.is_public).runs
    interrupted = store.list(
        state="interrupted", limit=_RECENT_RUNS, condition=store.is_public
    ).runs
    runs = {run.id: run for run in (*newest, *interrupted) if run.kind in WALKS}
    by_end = sorted(runs.values(), key=_last_activity, reverse=True)
    last = [
        run
        for run in by_end
        if run.state == by_end[0].state == "interrupted"
        and _last_activity(by_end[0]) - _last_activity(run) < _SAME_END
    ]
    recorded = next((run for run in last or by_end if _is_recorded(run, recordings)), None)
    return recorded or next(iter(last), None)


def newest_race(store: RunStore, recordings: Recordings) -> Run | None:
    """Return the newest finished race that is recorded; None without one."""
    races = store.list(
        kind="race", state="finished", limit=_RECENT_RUNS, condition=store.is_public
    ).runs
    return next((race for race in races if _is_recorded(race, recordings)), None)


def _is_recorded(run: Run, recordings: Recordings) -> bool:
    try:
        if run.kind == "race":
            return any(lane.steps for lane in recordings.race(run.id) or ())
        recording = recordings.training(run.id) if run.kind == "training" else None
    except HexapodError:
        return False  # its recording cannot be read
    return recording is not None and len(recording.steps) > 0


def _last_activity(run: Run) -> datetime:
    return run.ended_at or run.created_at
