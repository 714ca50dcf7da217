"""Results folder of an experiment: an append-only log of trials, from which it resumes.

Each result is appended to `trials.jsonl` as its trial ends, so that no trial is run twice. A
partial last line, left by a killed process, is truncated on opening.
"""

import json
import os
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Any

from hexapods.domain.checks import check_format
from hexapods.domain.errors import DamagedFile, HexapodError, InvalidInput
from hexapods.domain.records import from_json, to_json
from hexapods.experiments.config import SUMMARY, ExperimentConfig, by_option
from hexapods.experiments.progress import Progress
from hexapods.experiments.worker import Outcome, difference, versions
from hexapods.files import is_disk_full, lock_file

FORMAT = 2
"""Format of the header."""
TRIALS = "trials.jsonl"
"""JSON lines, append-only: a header, then one line per trial."""

_SYNC_S = 0.5
_CHOOSE = "choose another folder"


class ResultNotStored(HexapodError):
    """A result cannot be written; those written before it are kept."""


class ResultsFolder(Progress):
    """Progress of an experiment in a folder. Use `open_results` to open one.

    Attributes:
        path: the folder.
    """

    def __init__(self, path: Path, config: ExperimentConfig) -> None:
        super().__init__(config)
        self.path = path
        self._file: IO[bytes]
        self._synced_s = 0.0
        self._end = 0

    def add(self, outcome: Outcome) -> None:
        """Append a trial's outcome to the file.

        Once written it survives the death of this process; a power failure may lose the last
        0.5 s, the interval of `fsync`.

        Raises:
            ResultNotStored: if it cannot be written.
        """
        row = {**outcome.as_json(), "compute_s": round(outcome.compute_s, 6)}
        self._write({**row, "worked_s": round(self.wall_s, 3)})
        super().add(outcome)

    def begin(self, file: IO[bytes]) -> None:
        """Read the existing results in a file, or write the header of a new one.

        Raises:
            OtherFormat: if the file is of another version.
        InvalidInput: if it has the results of another experiment or of other software.
            DamagedFile: if the file was not written by `add`.
            ResultNotStored: if the header cannot be written.
        """
        self._file = file
        lines = file.read().splitlines(keepends=True)
        if lines and not lines[-1].endswith(b"\n"):
            lines.pop()  # a partial write: the process was killed while appending it
        if lines:
            self._check(self._head(lines[0]))
        self._end = sum(map(len, lines))
        # A file that is refused stays unchanged.
        file.truncate(self._end)
        if not lines:
            config = to_json(self.plan.config)
            kind = self.plan.config.kind
            self._write({"format": FORMAT, "kind": kind, "versions": versions(), "config": config})
            return
        for number, line in enumerate(lines[1:], start=2):
            self._read(number, line)

    def sync(self) -> None:
        """Flush the file to disk (`fsync`), so that the results survive a power failure."""
        with suppress(OSError):
            os.fsync(self._file.fileno())
        self._synced_s = time.monotonic()

    def _write(self, line: Mapping[str, Any]) -> None:
        data = json.dumps(line, allow_nan=False).encode() + b"\n"
        try:
            self._file.seek(self._end)
            rest = memoryview(data)
            while rest:  # a write is partial when the disk is nearly full
                rest = rest[self._file.write(rest) :]
        except OSError as error:
            with suppress(OSError):
                self._file.truncate(self._end)
            why = "the disk is full" if is_disk_full(error) else error.strerror
            raise ResultNotStored(
                f"cannot write to {self.path / TRIALS}: {why}; what was done is kept, and the "
                "same command goes on once it can be written"
            ) from error
        self._end += len(data)
        if time.monotonic() - self._synced_s > _SYNC_S:
            self.sync()

    def _head(self, line: bytes) -> dict[str, Any]:
        try:
            head = dict(json.loads(line))
            version = head["format"]
        except (KeyError, TypeError, ValueError):
            head, version = {}, FORMAT
        check_format(str(self.path / TRIALS), version, FORMAT)
        if all(isinstance(head.get(name), dict) for name in ("versions", "config")):
            return head
        raise DamagedFile(
            f"{self.path / TRIALS} does not begin as results of an experiment do; {_CHOOSE}"
        )

    def _check(self, head: Mapping[str, Any]) -> None:
        if head.get("kind") != self.plan.config.kind:
            raise InvalidInput(f"{self.path} has results of another experiment; {_CHOOSE}")
        differs = difference(versions(), head["versions"])
        if differs is not None:
            raise InvalidInput(f"{self.path} has results of {differs}; {_CHOOSE}")
        try:
            stored = by_option(to_json(from_json(type(self.plan.config), head["config"])))
        except (KeyError, TypeError, ValueError) as error:
            raise DamagedFile(f"{self.path / TRIALS} has a damaged head ({error})") from error
        requested = by_option(to_json(self.plan.config))
        # Each trial's seed depends on its number only, so that more seeds extend the results.
        every = dict.fromkeys((*requested, *stored))
        names = [
            name for name in every if name != "seeds" and requested.get(name) != stored.get(name)
        ]
        if "experiment" in names:
            raise InvalidInput(
                f"{self.path} has results of another experiment, {stored['experiment']}; {_CHOOSE}"
            )
        if names:
            options = ", ".join(map(self.plan.config.option_of, names))
            raise InvalidInput(
                f"{self.path} has results of another experiment, which differs in {options}; "
                f"{_CHOOSE}"
            )

    def _read(self, number: int, line: bytes) -> None:
        try:
            entry = json.loads(line)
            outcome = Outcome.from_json(entry)
            self.wall_s = float(entry["worked_s"])
        except (KeyError, TypeError, ValueError) as error:
            raise DamagedFile(
                f"{self.path / TRIALS} is damaged in line {number}; delete that line, and its "
                "trial is run again"
            ) from error
        super().add(outcome)


@contextmanager
def open_results(path: Path, config: ExperimentConfig) -> Iterator[ResultsFolder]:
    """Open or create an experiment's results folder, under an exclusive file lock.

    Existing results of the same experiment with fewer or more seeds are reused.

    Raises:
        OtherFormat: if the results file is of another version.
        InvalidInput: if the folder cannot be used, is locked by another process, or contains
            other files or another experiment's results.
        DamagedFile: if the results file cannot be read.
        ResultNotStored: if the header of a new file cannot be written.
    """
    # Before the folder is made, since it refuses an invalid config.
    folder = ResultsFolder(path, config)
    with _opened(path) as file:
        try:
            lock_file(file)
        except OSError as error:
            raise InvalidInput(
                f"another process is adding results to {path}; wait for it, or {_CHOOSE}"
            ) from error
        folder.begin(file)
        try:
            yield folder
        finally:
            folder.sync()


def _opened(path: Path) -> IO[bytes]:
    try:
        path.mkdir(parents=True, exist_ok=True)
        names = {entry.name for entry in path.iterdir()}
        if names and not names & {TRIALS, SUMMARY}:
            raise InvalidInput(f"{path} is not empty, and has no results in it; {_CHOOSE}")
        # Unbuffered, so that closing the file does not retry a write that failed.
        return (path / TRIALS).open("r+b" if TRIALS in names else "x+b", buffering=0)
    except OSError as error:
        raise InvalidInput(
            f"cannot keep results in {path} ({error.strerror}); {_CHOOSE}"
        ) from error
