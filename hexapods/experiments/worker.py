"""Workers, and the task that runs on them: a batch of trials, by the same software.

A trial's result depends on the versions of the software, so a worker with others is refused.
"""

import platform
import time
from collections.abc import Callable, Mapping, Sequence
from importlib.metadata import version
from typing import Any, NamedTuple, Protocol

from hexapods.domain.errors import HexapodError
from hexapods.experiments.plan import Trial
from hexapods.experiments.trial import TrialResult, run_trial
from hexapods.version import __version__


class ClusterLost(HexapodError):
    """The workers cannot be reached, or none is left; finished results are kept."""


class WorkerDied(Exception):
    """A worker's process ended, as often as `times` says, while it computed a task."""

    def __init__(self, times: int = 1) -> None:
        super().__init__(times)
        self.times = times


class VersionMismatch(HexapodError):
    """A worker that joined later has other versions, and would compute other results."""


class Outcome(NamedTuple):
    """A completed trial: its result, or the reason that it was set aside."""

    key: str
    result: TrialResult | None
    """Result of the trial; None if it was set aside."""
    set_aside: str | None
    """The reason that there is no result, in a sentence."""
    compute_s: float
    """Time that a worker computed."""

    def as_json(self) -> dict[str, Any]:
        """Encode to plain JSON types, as stored in databases and results folders."""
        result = None if self.result is None else self.result.as_json()
        return {**self._asdict(), "result": result}

    @classmethod
    def from_json(cls, row: Mapping[str, Any]) -> "Outcome":
        """Decode the output of `as_json`.

        Raises:
            KeyError, TypeError, ValueError: if it is malformed.
        """
        result = None if row["result"] is None else TrialResult.from_json(row["result"])
        return cls(str(row["key"]), result, row["set_aside"], float(row["compute_s"]))


class BatchFuture(Protocol):
    """A batch of trials that is being computed: a future, as Python's or Dask's."""

    def add_done_callback(self, function: Callable[[Any], None], /) -> None:
        """Call a function with it once it has ended, in another thread."""


class Workers(Protocol):
    """Processes that run trials: of this machine, or of a Dask cluster."""

    def count(self) -> int:
        """Return the number of tasks computed concurrently; raises ClusterLost without workers."""

    def submit(self, trials: Sequence[Trial]) -> BatchFuture:
        """Let a worker run a batch of trials."""

    def result(self, task: Any) -> list[Outcome]:
        """Return the result of a task that has ended.

        Raises:
            WorkerDied: if its worker process ended.
            ClusterLost: if the workers are lost.
            VersionMismatch: see `run_batch`.
            Exception: if the task could not be decoded.
        """


def run_batch(trials: Sequence[Trial], expected: Mapping[str, str]) -> list[Outcome]:
    """Run a batch of trials on a worker, one after the other.

    Args:
        trials: the trials.
        expected: versions of the submitting process, as by `versions`.

    Raises:
        VersionMismatch: if this worker has other versions than were expected.
    """
    differs = difference(expected, versions())
    if differs is not None:
        raise VersionMismatch(f"a worker that joined would compute other results: it has {differs}")
    return [_run(trial) for trial in trials]


def _run(trial: Trial) -> Outcome:
    began_s = time.perf_counter()
    result, reason = None, None
    try:
        result = run_trial(trial.config)
    except HexapodError as error:
        reason = str(error)
    # User-supplied agents are untrusted code: they may raise anything, and call `sys.exit`.
    except (Exception, SystemExit) as error:
        reason = f"something in it broke ({type(error).__name__}: {error})"
    return Outcome(trial.key, result, reason, time.perf_counter() - began_s)


def versions() -> dict[str, str]:
    """Return the versions of the product, Python, NumPy and MuJoCo in this process.

    Of MuJoCo that of the engine that is loaded: another package may have written over the installed
    one's files.
    """
    from hexapods.physics.engine import loaded_version  # noqa: PLC0415  # takes a fifth of a second

    return {
        "racing-hexapods": __version__,
        "python": platform.python_version(),
        "numpy": version("numpy"),
        "mujoco": loaded_version(),
    }


def difference(versions_here: Mapping[str, str], versions_there: Mapping[str, str]) -> str | None:
    """Return the differences of two processes' versions in words; None if results are comparable.

    Python's patch version is ignored.
    """
    names = [
        name
        for name in versions_here
        if _comparable(versions_here, name) != _comparable(versions_there, name)
    ]
    if not names:
        return None
    return ", ".join(
        f"{name} {versions_there.get(name, 'none')} instead of {versions_here[name]}"
        for name in names
    )


def _comparable(installed: Mapping[str, str], name: str) -> str | None:
    value = installed.get(name)
    return value.rpartition(".")[0] if name == "python" and value else value
