"""Trainings and races of the command line that stay in the data folder, for the page to show."""

import signal
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from app.cli.exit_codes import FAILED, INTERRUPTED
from app.cli.run_keeper import AnyStart, KeptRun, Progress, RunKeeper, run_keeper
from app.cli.terminal import progress
from app.jobs.submissions import LaneStart, RaceStart, TrainingStart
from app.settings import Settings
from app.storage.run import NOT_ENDED
from hexapods.domain.errors import InvalidInput
from hexapods.interruption import stop_signals
from hexapods.races import Race
from hexapods.runs.config import TrainingConfig, WalkingProblem, usable_agents
from hexapods.runs.lane import LANE_FIELDS
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.results import race_result
from hexapods.trainings import CurvePoint, Training, training_from_bytes

if TYPE_CHECKING:
    from threading import Event

_LOOK_EVERY_S = 0.2


class Kept(NamedTuple):
    """A run in the data folder.

    Attributes:
        id: id of the run.
        kind: its kind, as in sentences.
        progress: how it has ended.
        steps: number of its steps; of a race, of all its lanes.
        was_interrupted: whether Ctrl-C has stopped it.
        address: of the server that has computed it; None if this process has.
    """

    id: str
    kind: str
    progress: Progress
    steps: int
    was_interrupted: bool
    address: str | None

    def report_unfinished(self) -> int:
        """Say on standard error how far the run came; return the exit code."""
        ended = self.progress
        how = "Stopped" if ended.state == "stopped" else f"It {ended.state}"
        reason = "" if ended.error is None else f" ({ended.error.rstrip('.')})"
        print(
            f"{how} after {ended.done:,} of {self.steps:,} steps{reason}; they are kept as "
            f"{self.kind} {self.id}, {ended.name!r}, which Resume on the page goes on with.",
            file=sys.stderr,
        )
        return INTERRUPTED if self.was_interrupted else FAILED

    def print_where(self) -> None:
        """Say where the run is kept, and what shows it."""
        shows = "`hexapods serve`" if self.address is None else self.address
        print(f"It is kept as {self.kind} {self.id}, {self.progress.name!r}; {shows} shows it.")


def check_keepable(agents: Iterable[str]) -> None:
    """Check that the page can show what agents do.

    Raises:
        InvalidInput: if one is not registered, so that a server does not know it.
    """
    registered = usable_agents()
    for agent in agents:
        if agent not in registered:
            raise InvalidInput(
                "--keep is for agents that every server of the data folder knows, not for "
                f"{agent}: {', '.join(registered)}; a package registers further ones "
                "(docs/your-agent.md)"
            )


def keep_training(
    settings: Settings,
    config: TrainingConfig,
    *,
    name: str | None,
    table: str | None,
) -> tuple[Kept, Training | None]:
    """Train with a progress bar, and keep the training with all that one of the page has.

    The first Ctrl-C stops it as *Stop* on the page does; a second one ends this process at once.

    Args:
        settings: say which data folder.
        config: of the training.
        name: of the run; None for a generated one.
        table: path of the table that it begins with, which is kept as a training, too.

    Returns:
        what is kept, and the training with its curve; None unless it is finished.

    Raises:
        HexapodError: if the folder cannot be used, or the training not be started.
    """
    with _keeping(settings) as (keeper, interrupted):
        (continue_from,) = _add_tables(keeper, [table])
        start = TrainingStart(config, name, continue_from)
        run, kept = _compute(keeper, start, config.steps, interrupted)
        if kept.progress.state != "finished":
            return kept, None
        learned = training_from_bytes(run.table(), "the table")
        curve = tuple(CurvePoint(**point) for point in run.curve())
        return kept, Training(learned.config, learned.table, curve, run.training_result())


def keep_race(
    settings: Settings,
    config: RaceConfig,
    *,
    name: str | None,
    tables: Sequence[str | None],
) -> tuple[Kept, Race | None]:
    """Race with a progress bar, and keep the race with all that one of the page has.

    Args:
        settings, name: as of `keep_training`, also of Ctrl-C.
        config: of the race.
        tables: by lane the path of its table, which is kept as a training, too; None without one.

    Returns:
        what is kept, and the race; None unless it is finished.

    Raises:
        HexapodError: if the folder cannot be used, or the race not be started.
    """
    with _keeping(settings) as (keeper, interrupted):
        training_ids = _add_tables(keeper, tables)
        run, kept = _compute(
            keeper,
            _race_start(config, name, training_ids),
            config.steps * len(config.lanes),
            interrupted,
        )
        if kept.progress.state != "finished":
            return kept, None
        lanes = run.lanes()
        return kept, Race(config, lanes, race_result(lanes, config))


def _race_start(
    config: RaceConfig, name: str | None, training_ids: Sequence[str | None]
) -> RaceStart:
    """Return the start of a race whose trained lanes have these trainings."""
    walk = WalkingProblem(
        **{field.name: getattr(config, field.name) for field in fields(WalkingProblem)}
    )
    lanes = [
        LaneStart(
            lane.agent,
            training_id,
            given={field: getattr(lane, field) for field in LANE_FIELDS},
            settings=lane.settings,
        )
        for lane, training_id in zip(config.lanes, training_ids, strict=True)
    ]
    return RaceStart(walk, lanes, config.steps, config.seed, name)


@contextmanager
def _keeping(settings: Settings) -> "Iterator[tuple[RunKeeper, Event]]":
    """Yield what computes runs of the data folder, and the event that Ctrl-C sets."""
    with run_keeper(settings) as keeper, stop_signals(signal.SIGINT) as interrupted:
        yield keeper, interrupted


def _add_tables(keeper: RunKeeper, paths: Sequence[str | None]) -> list[str | None]:
    """Keep the tables of files as trainings, each once, and return the id of each path's."""
    ids = {
        path: keeper.add_table(Path(path).read_bytes())
        for path in dict.fromkeys(paths)
        if path is not None
    }
    return [None if path is None else ids[path] for path in paths]


def _compute(
    keeper: RunKeeper, start: AnyStart, steps: int, interrupted: "Event"
) -> tuple[KeptRun, Kept]:
    """Start a run, and wait with a progress bar until it has ended; stop it when interrupted."""
    kind, doing = ("race", "racing") if isinstance(start, RaceStart) else ("training", "practising")
    run = keeper.start(start)
    with progress() as bar:
        task = bar.add_task(doing, total=steps)
        while (now := run.look()).state in NOT_ENDED:
            description = doing if now.state == "running" else now.state
            bar.update(task, completed=now.done, description=description)
            if interrupted.wait(_LOOK_EVERY_S):
                run.stop()
                now = run.look()
                break
    return run, Kept(run.id, kind, now, steps, interrupted.is_set(), keeper.address)
