"""Compute runs that stay in the data folder: by its server, or by jobs of this process.

A server computes such a run as those that its page starts. Without one, this process opens the
folder as a server would, and its jobs are the same, so that what is kept is the same in both.
"""

import signal
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol
from urllib.parse import quote

from app.cli.server_client import call_server, fetch_from_server
from app.cli.stored_runs import open_for_writing
from app.settings import Settings
from app.storage.run import NOT_ENDED, TABLE, State
from app.storage.server_lock import FolderInUse, read_address_file, remove_address_file
from hexapods.domain.errors import InvalidInput
from hexapods.domain.records import from_json, to_json
from hexapods.interruption import stop_signals
from hexapods.runs.config import TrainingConfig, usable_agents
from hexapods.runs.results import TrainingResult
from hexapods.trainings import CurvePoint, Training, training_from_bytes

if TYPE_CHECKING:
    from app.jobs.jobs import Jobs
    from app.storage.database.store import RunStore

_LOOK_EVERY_S = 0.2
_PRELOADED = ["app.jobs.worker", "hexapods.physics.mujoco_simulator"]
"""Modules that the processes of jobs import."""


class Progress(NamedTuple):
    """A training that is kept, as it is now.

    Attributes:
        name: its name.
        state: its state.
        done: steps that are done.
        error: why it has ended before its last step, a sentence; None if it has not.
        result: distances and hash of the table; None before its end.
    """

    name: str
    state: State
    done: int
    error: str | None
    result: TrainingResult | None


class KeptTraining(NamedTuple):
    """A training in the data folder.

    Attributes:
        id: id of the run.
        progress: how it has ended.
        was_interrupted: whether Ctrl-C has stopped it.
        training: it with its curve; None unless it is finished.
        address: of the server that has computed it; None if this process has.
    """

    id: str
    progress: Progress
    was_interrupted: bool
    training: Training | None
    address: str | None


class RunKeeper(Protocol):
    """Computes trainings, and keeps them."""

    address: str | None
    """Of the server; None if this process computes."""

    def add_table(self, data: bytes) -> str:
        """Keep a table as a finished training, and return its id."""

    def start(self, config: TrainingConfig, name: str | None, continue_from: str | None) -> str:
        """Queue a training, and return its id."""

    def look(self, training_id: str) -> Progress:
        """Return how far a training is."""

    def stop(self, training_id: str) -> None:
        """Stop a training between two steps; what is done is kept."""

    def table(self, training_id: str) -> bytes:
        """Return the file of a training's table."""

    def curve(self, training_id: str) -> list[dict[str, Any]]:
        """Return the evaluations of a training."""


def check_keepable(agent: str) -> None:
    """Check that the page can show what an agent learns.

    Raises:
        InvalidInput: if the agent is not registered, so that a server does not know it.
    """
    if agent not in (registered := usable_agents()):
        raise InvalidInput(
            f"--keep is for agents that every server of the data folder knows, not for {agent}: "
            f"{', '.join(registered)}; a package registers further ones (docs/your-agent.md)"
        )


def keep_training(
    settings: Settings,
    config: TrainingConfig,
    *,
    name: str | None = None,
    table: bytes | None = None,
    on_progress: Callable[[Progress], object] = lambda progress: None,  # noqa: ARG005
) -> KeptTraining:
    """Train, and keep the training in the data folder with all that one of the page has.

    The first Ctrl-C stops it as *Stop* on the page does; a second one ends this process at once.

    Args:
        settings: say which data folder.
        config: of the training.
        name: of the run; None for a generated one.
        table: file of the table that it begins with, which is kept as a training, too.
        on_progress: called some times a second.

    Raises:
        HexapodError: if the folder cannot be used, or the training not be started.
    """
    with run_keeper(settings) as keeper, stop_signals(signal.SIGINT) as interrupted:
        continue_from = None if table is None else keeper.add_table(table)
        training_id = keeper.start(config, name, continue_from)
        while (progress := keeper.look(training_id)).state in NOT_ENDED:
            on_progress(progress)
            if interrupted.wait(_LOOK_EVERY_S):
                keeper.stop(training_id)
                progress = keeper.look(training_id)
                break
        training = None
        if progress.state == "finished":
            learned = training_from_bytes(keeper.table(training_id), "the table")
            curve = tuple(CurvePoint(**point) for point in keeper.curve(training_id))
            training = Training(learned.config, learned.table, curve, progress.result)
        return KeptTraining(training_id, progress, interrupted.is_set(), training, keeper.address)


@contextmanager
def run_keeper(settings: Settings) -> Iterator[RunKeeper]:
    """Yield what computes runs of a data folder: its server, or else jobs of this process.

    Raises:
        HexapodError: if the folder cannot be opened, as `open_for_writing`.
    """
    with ExitStack() as opened:
        try:
            store = opened.enter_context(open_for_writing(settings))
        except FolderInUse:
            store = None
        if store is None:
            yield _ServerJobs(settings)
        else:
            yield opened.enter_context(_jobs_here(store, settings))


class _ServerJobs:
    """Computes by the server that has the data folder."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self.address = read_address_file(settings.data)

    def add_table(self, data: bytes) -> str:
        return self._id(call_server(self._settings, "POST", "api/v1/trainings/import", data))

    def start(self, config: TrainingConfig, name: str | None, continue_from: str | None) -> str:
        body = {**to_json(config), "name": name, "continue_from": continue_from}
        if continue_from is not None:
            del body["seed"]  # the generator of the table goes on
        return self._id(call_server(self._settings, "POST", "api/v1/trainings", body))

    def look(self, training_id: str) -> Progress:
        view = call_server(self._settings, "GET", _path(training_id))
        result = None
        if view["result"] is not None:
            result = from_json(TrainingResult, view["result"])
        done = view["progress"]["done"]
        return Progress(view["name"], view["state"], done, view["error"], result)

    def stop(self, training_id: str) -> None:
        if self.look(training_id).state in NOT_ENDED:
            call_server(self._settings, "POST", f"{_path(training_id)}/stop")

    def table(self, training_id: str) -> bytes:
        return fetch_from_server(self._settings, f"{_path(training_id)}/q-table?format=npz")

    def curve(self, training_id: str) -> list[dict[str, Any]]:
        answer = call_server(self._settings, "GET", f"{_path(training_id)}/curve")
        evaluations: list[dict[str, Any]] = answer["evaluations"]
        return evaluations

    @staticmethod
    def _id(run: Any) -> str:
        return str(run["id"])


def _path(training_id: str) -> str:
    return f"api/v1/trainings/{quote(training_id, safe='')}"


@contextmanager
def _jobs_here(store: "RunStore", settings: Settings) -> "Iterator[_OwnJobs]":
    """Yield jobs of this process; at the end unfinished runs are `interrupted`."""
    # Imported here, as they would slow the start of commands that keep nothing.
    from app.events.bus import EventBus  # noqa: PLC0415
    from app.jobs.jobs import Jobs  # noqa: PLC0415
    from app.storage.recordings import Recordings  # noqa: PLC0415
    from hexapods.processes import start_fork_server  # noqa: PLC0415

    remove_address_file(settings.data)  # of a server that has ended
    start_fork_server(_PRELOADED)
    jobs = Jobs(store, Recordings(store), EventBus())
    jobs.open()
    try:
        yield _OwnJobs(jobs, store)
    finally:
        jobs.close()


class _OwnJobs:
    """Computes by jobs of this process."""

    address: str | None = None

    def __init__(self, jobs: "Jobs", store: "RunStore") -> None:
        self._jobs, self._store = jobs, store

    def add_table(self, data: bytes) -> str:
        from app.jobs.table_import import import_table  # noqa: PLC0415 - as above

        self._store.check_disk_space(len(data))
        return import_table(self._jobs, data, usable_agents()).id

    def start(self, config: TrainingConfig, name: str | None, continue_from: str | None) -> str:
        from app.jobs.submissions import TrainingStart  # noqa: PLC0415 - as above

        self._store.check_disk_space()
        return self._jobs.start(TrainingStart(config, name, continue_from)).id

    def look(self, training_id: str) -> Progress:
        run = self._store.get(training_id)
        return Progress(run.name, run.state, run.done, run.error, run.result)

    def stop(self, training_id: str) -> None:
        if self.look(training_id).state in NOT_ENDED:
            self._jobs.stop(training_id)

    def table(self, training_id: str) -> bytes:
        table = self._store.artifact(training_id, TABLE)
        if table is None:
            raise InvalidInput(f"training {training_id} has no table")
        return table

    def curve(self, training_id: str) -> list[dict[str, Any]]:
        return [dict(point) for point in self._store.curves.get(training_id)]
