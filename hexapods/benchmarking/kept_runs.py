"""Finished runs of a benchmark: in its score file, and beside it while the benchmark runs."""

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from hexapods.benchmarking.config import BenchmarkConfig
from hexapods.benchmarking.runs import BenchmarkResult, BenchmarkRun
from hexapods.benchmarking.score_file import config_of, decode, results_of
from hexapods.domain.errors import DamagedFile, InvalidInput
from hexapods.domain.records import to_json
from hexapods.experiments.worker import difference, versions
from hexapods.files import lock_file

ENDING = ".runs"
"""Ending of the file's name, after the name of the score file."""


class KeptRuns:
    """Results of finished runs, in memory and, if one is given, in a file.

    Attributes:
        results: result of each run.
    """

    def __init__(self, path: Path | None = None, file: IO[bytes] | None = None) -> None:
        """Begin without results.

        Args:
            path: path of the file.
            file: open file to which results are appended; None for memory alone.
        """
        self.results: dict[BenchmarkRun, BenchmarkResult] = {}
        self._path, self._file = path, file

    def add(self, run: BenchmarkRun, result: BenchmarkResult) -> None:
        """Add the result of a run, and write it at once."""
        self.results[run] = result
        if self._file is not None:
            self._file.write(json.dumps([*run, *result]).encode() + b"\n")
            self._file.flush()

    def delete(self) -> None:
        """Delete the file, when the score file has its results."""
        if self._path is not None:
            self._path.unlink(missing_ok=True)


@contextmanager
def kept_runs(score_file: Path | None, config: BenchmarkConfig) -> Iterator[KeptRuns]:
    """Yield the results of the finished runs of a benchmark, to which others are added.

    They are those of the score file, if it is of the same agent, and those beside it. Its tasks,
    budgets and seeds may differ from the config: the runs of both count.

    Args:
        score_file: path beside which results are kept; None to keep them in memory alone.
        config: the benchmark.

    Raises:
        InvalidInput: if the file is of another benchmark, or cannot be written.
        DamagedFile: if it cannot be read.
    """
    if score_file is None:
        yield KeptRuns()
        return
    path = score_file.with_name(score_file.name + ENDING)
    stored = _scored(score_file, config) if score_file.exists() else {}
    try:
        file = path.open("a+b")
    except OSError as error:
        raise InvalidInput(f"cannot keep runs in {path}: {error.strerror}") from error
    with file:
        try:
            lock_file(file)
        except OSError as error:
            raise InvalidInput(f"another process is adding runs to {path}; wait for it") from error
        runs = KeptRuns(path, file)
        runs.results |= stored
        _read(file, path, config, runs)
        yield runs


def _scored(path: Path, config: BenchmarkConfig) -> dict[BenchmarkRun, BenchmarkResult]:
    """Return the runs of a score file.

    Raises:
        InvalidInput: if it is of another benchmark, or of other versions.
        DamagedFile: if it is no score file.
    """
    content = decode(path.read_bytes(), str(path))
    if _same_in_all(config_of(content)) != _same_in_all(config):
        raise InvalidInput(f"{path} has the scores of another benchmark; choose another --out")
    differs = difference(versions(), content["versions"])
    if differs is not None:
        raise InvalidInput(f"{path} has scores of {differs}; choose another --out")
    return results_of(content)


def _read(file: IO[bytes], path: Path, config: BenchmarkConfig, runs: KeptRuns) -> None:
    file.seek(0)
    lines = file.read().splitlines(keepends=True)
    if lines and not lines[-1].endswith(b"\n"):
        file.truncate(len(b"".join(lines[:-1])))  # the process was killed while it wrote that one
        lines.pop()
    if not lines:
        head = {"config": _same_in_all(config), "versions": versions()}
        file.write(json.dumps(head).encode() + b"\n")
        file.flush()
        return
    other = f"choose another --out, or delete {path}"
    try:
        head, *rows = [json.loads(line) for line in lines]
        is_same = head["config"] == json.loads(json.dumps(_same_in_all(config)))
        differs = difference(versions(), head["versions"])
        for task, budget, number, distance_m, error in rows:
            runs.results[BenchmarkRun(task, budget, number)] = BenchmarkResult(distance_m, error)
    except (KeyError, TypeError, ValueError) as error:
        raise DamagedFile(f"{path} cannot be read ({error}); {other}") from error
    if not is_same:
        raise InvalidInput(f"{path} has runs of another benchmark; {other}")
    if differs is not None:
        raise InvalidInput(f"{path} has runs of {differs}; {other}")


def _same_in_all(config: BenchmarkConfig) -> Mapping[str, object]:
    """Return the fields that all runs of a file share; tasks, budgets and seeds may grow."""
    growing = ("tasks", "budgets", "seeds")
    return {name: value for name, value in to_json(config).items() if name not in growing}
