"""Compute runs that stay in the data folder: by its server, or by jobs of this process.

A server computes such a run as those that its page starts. Without one, this process opens the
folder as a server would, and its jobs are the same, so that what is kept is the same in both.
"""

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol
from urllib.parse import quote

from app.cli.server_client import call_server, fetch_from_server
from app.cli.stored_runs import open_for_writing
from app.jobs.submissions import RaceStart, TrainingStart
from app.settings import Settings
from app.storage.run import NOT_ENDED, TABLE, State
from app.storage.server_lock import FolderInUse, read_address_file, remove_address_file
from hexapods.domain.errors import InvalidInput
from hexapods.domain.records import from_json, to_json
from hexapods.runs.config import usable_agents
from hexapods.runs.race_file import race_recording
from hexapods.runs.recording import LaneRecording
from hexapods.runs.results import TrainingResult
from hexapods.runs.tables import read_arrays

if TYPE_CHECKING:
    from app.jobs.jobs import Jobs
    from app.storage.database.store import RunStore
    from app.storage.recordings import Recordings

_PRELOADED = ["app.jobs.worker", "hexapods.physics.mujoco_simulator"]
"""Modules that the processes of jobs import."""
AnyStart = TrainingStart | RaceStart


class Progress(NamedTuple):
    """A run that is kept, as it is now.

    Attributes:
        name: its name.
        state: its state.
        done: steps that are done; of a race, of all its lanes.
        error: why it has ended before its last step, a sentence; None if it has not.
    """

    name: str
    state: State
    done: int
    error: str | None


class KeptRun(Protocol):
    """A run in the data folder, which is computed there."""

    id: str

    def look(self) -> Progress:
        """Return how far it is."""

    def stop(self) -> None:
        """Stop it between two steps, unless it has ended; what is done is kept."""

    def training_result(self) -> TrainingResult | None:
        """Return distances and hash of the table of a training; None before its end."""

    def table(self) -> bytes:
        """Return the file of the table of a training."""

    def curve(self) -> list[dict[str, Any]]:
        """Return the evaluations of a training."""

    def lanes(self) -> Sequence[LaneRecording]:
        """Return the recording of a race that has ended."""


class RunKeeper(Protocol):
    """Computes runs, and keeps them."""

    address: str | None
    """Of the server; None if this process computes."""

    def add_table(self, data: bytes) -> str:
        """Keep a table as a finished training, and return its id."""

    def start(self, start: AnyStart) -> KeptRun:
        """Queue a run."""


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
        return str(call_server(self._settings, "POST", "api/v1/trainings/import", data)["id"])

    def start(self, start: AnyStart) -> "_ServerRun":
        if isinstance(start, RaceStart):
            path, body = "api/v1/races", _race_body(start)
        else:
            path, body = "api/v1/trainings", _training_body(start)
        return _ServerRun(self._settings, path, call_server(self._settings, "POST", path, body))


def _training_body(start: TrainingStart) -> dict[str, Any]:
    """Return the request that starts a training."""
    body = {**to_json(start.config), "name": start.name, "continue_from": start.continue_from}
    if start.continue_from is not None:
        del body["seed"]  # the generator of the table goes on
    return body


def _race_body(start: RaceStart) -> dict[str, Any]:
    """Return the request that starts a race."""
    lanes = [
        {
            "agent": lane.agent,
            "training_id": lane.training_id,
            "settings": dict(lane.settings),
            **lane.given,
        }
        for lane in start.lanes
    ]
    numbers = {"steps": start.steps, "seed": start.seed}
    return {**to_json(start.walk), **numbers, "lanes": lanes, "name": start.name}


class _ServerRun:
    """A run of the server that has the data folder."""

    def __init__(self, settings: Settings, path: str, view: Any) -> None:
        self._settings, self.id = settings, str(view["id"])
        self._path = f"{path}/{quote(self.id, safe='')}"

    def look(self) -> Progress:
        view = self._view()
        return Progress(view["name"], view["state"], view["progress"]["done"], view["error"])

    def stop(self) -> None:
        if self.look().state in NOT_ENDED:
            call_server(self._settings, "POST", f"{self._path}/stop")

    def training_result(self) -> TrainingResult | None:
        result = self._view()["result"]
        return None if result is None else from_json(TrainingResult, result)

    def table(self) -> bytes:
        return fetch_from_server(self._settings, f"{self._path}/q-table?format=npz")

    def curve(self) -> list[dict[str, Any]]:
        answer = call_server(self._settings, "GET", f"{self._path}/curve")
        evaluations: list[dict[str, Any]] = answer["evaluations"]
        return evaluations

    def lanes(self) -> Sequence[LaneRecording]:
        data = fetch_from_server(self._settings, f"{self._path}/recording?format=npz")
        return race_recording(read_arrays(data))

    def _view(self) -> Any:
        return call_server(self._settings, "GET", self._path)


@contextmanager
def _jobs_here(store: "RunStore", settings: Settings) -> "Iterator[_OwnJobs]":
    """Yield jobs of this process; at the end unfinished runs are `interrupted`."""
    # Imported here, as a command whose runs a server computes has no jobs.
    from app.events.bus import EventBus  # noqa: PLC0415
    from app.jobs.jobs import Jobs  # noqa: PLC0415
    from app.storage.recordings import Recordings  # noqa: PLC0415
    from hexapods.processes import start_fork_server  # noqa: PLC0415

    remove_address_file(settings.data)  # of a server that has ended
    start_fork_server(_PRELOADED)
    recordings = Recordings(store)
    jobs = Jobs(store, recordings, EventBus())
    jobs.open()
    try:
        yield _OwnJobs(jobs, store, recordings)
    finally:
        jobs.close()


class _OwnJobs:
    """Computes by jobs of this process."""

    address: str | None = None

    def __init__(self, jobs: "Jobs", store: "RunStore", recordings: "Recordings") -> None:
        self._jobs, self._store, self._recordings = jobs, store, recordings

    def add_table(self, data: bytes) -> str:
        from app.jobs.table_import import import_table  # noqa: PLC0415 - as above

        self._store.check_disk_space(len(data))
        return import_table(self._jobs, data, usable_agents()).id

    def start(self, start: AnyStart) -> "_OwnRun":
        self._store.check_disk_space()
        return _OwnRun(self._jobs.start(start).id, self._jobs, self._store, self._recordings)


class _OwnRun:
    """A run of jobs of this process."""

    def __init__(
        self, run_id: str, jobs: "Jobs", store: "RunStore", recordings: "Recordings"
    ) -> None:
        self.id, self._jobs, self._store, self._recordings = run_id, jobs, store, recordings

    def look(self) -> Progress:
        run = self._store.get(self.id)
        return Progress(run.name, run.state, run.done, run.error)

    def stop(self) -> None:
        if self.look().state in NOT_ENDED:
            self._jobs.stop(self.id)

    def training_result(self) -> TrainingResult | None:
        result = self._store.get(self.id).result
        return result if isinstance(result, TrainingResult) else None

    def table(self) -> bytes:
        table = self._store.artifact(self.id, TABLE)
        if table is None:
            raise InvalidInput(f"training {self.id} has no table")
        return table

    def curve(self) -> list[dict[str, Any]]:
        return [dict(point) for point in self._store.curves.get(self.id)]

    def lanes(self) -> Sequence[LaneRecording]:
        lanes = self._recordings.race(self.id)
        if lanes is None:
            raise InvalidInput(f"race {self.id} has no recording")
        return lanes
