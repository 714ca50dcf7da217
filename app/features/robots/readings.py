"""RobotReadings: robots' files that are looked at and corrected before a robot is stored.

A file that was sent is kept for a while, so that a correction does not send it again. Nothing of it
is written to disk.
"""

import hashlib
import threading
from typing import NamedTuple

from cachetools import LRUCache

from app.storage.errors import Busy, NotFound
from hexapods.domain.records import to_json_bytes
from hexapods.imports.child import NotRead, inspect_robot_file
from hexapods.imports.choices import AS_FOUND, Choices
from hexapods.imports.imported import RobotReading

_ID_DIGITS = 32
_MAX_KEPT_BYTES = 128 << 20
"""Size of all files that are kept; an upload has at most half of it."""
_MAX_READINGS = 16
_RETRY_S = 5


class KeptFile(NamedTuple):
    """A file of a robot.

    Attributes:
        name: its name.
        data: its content.
    """

    name: str
    data: bytes


def is_model_file(data: bytes) -> bool:
    """Whether data are a file, of a robot or anything else, and no JSON after blanks and a mark."""
    start = data[:1000].lstrip(b"\xef\xbb\xbf \t\r\n")
    return bool(data) and not start.startswith((b"{", b"["))


class RobotReadings:
    """Files of robots that were looked at lately, and what was read from them. Thread-safe."""

    def __init__(self, max_bytes: int = _MAX_KEPT_BYTES) -> None:
        """Keep nothing yet.

        Args:
            max_bytes: size of all files that are kept; the newest is kept whatever its size.
        """
        self._lock = threading.Lock()
        self._files: LRUCache[str, KeptFile] = LRUCache(
            max_bytes, lambda kept: min(len(kept.data), max_bytes)
        )
        self._readings: LRUCache[tuple[str, bytes], RobotReading] = LRUCache(_MAX_READINGS)

    def keep(self, data: bytes, name: str | None) -> str:
        """Keep a file for a while, and return its id: of its name and its content."""
        file_name = name or "robot.xml"
        named = f"{len(file_name)} {file_name} ".encode() + data
        file_id = hashlib.sha256(named).hexdigest()[:_ID_DIGITS]
        with self._lock:
            self._files[file_id] = KeptFile(file_name, data)
        return file_id

    def file(self, file_id: str) -> KeptFile:
        """Return a file.

        Raises:
            NotFound: if it is not kept any more, or never was.
        """
        with self._lock:
            kept = self._files.get(file_id)
        if kept is None:
            raise NotFound(f"the file of reading {file_id!r} is not here any more: send it again")
        return kept

    def read(self, file_id: str, choices: Choices = AS_FOUND) -> RobotReading:
        """Read a file as a person decided; the same reading is not made twice.

        Raises:
            InvalidInput: if the file cannot even be drawn.
            NotFound: if it is not kept any more.
            Busy: if no process can read it at present.
        """
        kept = self.file(file_id)
        key = file_id, to_json_bytes(choices)
        with self._lock:
            cached = self._readings.get(key)
        if cached is not None:
            return cached
        try:
            reading = inspect_robot_file(kept.data, kept.name, choices)
        except NotRead as error:
            raise Busy(str(error), _RETRY_S) from error
        with self._lock:
            self._readings[key] = reading
        return reading
