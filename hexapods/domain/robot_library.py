"""Stored robots by id: their documents, and the names and gaits that are stored beside them."""

import threading
from collections.abc import Collection, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from hexapods.domain.errors import DamagedFile, InvalidInput
from hexapods.domain.robot_documents import ENDING, id_of, is_id

_MAX_CACHED = 16
_MAX_LISTED = 10


class About(NamedTuple):
    """Data of a stored robot beside its document.

    Attributes:
        name: its name for users.
        gait: one that suits it, as in JSON; None if none is known.
    """

    name: str
    gait: Any = None


class RobotLibrary:
    """The stored robots that a robot's id may refer to. Thread-safe.

    A document is in memory, or in a file of one of the folders, which is read when it is needed. A
    library may extend another library, whose robots it finds too, and which it never changes.

    It can be pickled, so that another process finds the same robots.

    Attributes:
        documents: documents in memory, by id.
        descriptions: data stored beside documents, by id.
        folders: folders with files of documents.
        withdrawn: files in these folders that are not found, by folder and id.
    """

    def __init__(self, base: "RobotLibrary | None" = None, documents: Iterable[bytes] = ()) -> None:
        """Create a library with documents, which are not validated.

        Args:
            base: the library that this one extends.
            documents: documents in memory, beside those of `base`.
        """
        self._base = base
        self._lock = threading.RLock()
        self.documents = {id_of(data): data for data in documents}
        self.descriptions: dict[str, About] = {}
        self.folders: list[Path] = []
        self.withdrawn: set[tuple[Path, str]] = set()
        self._cached: dict[str, bytes] = {}

    def __getstate__(self) -> dict[str, Any]:
        with self._lock:
            names = "_base", "documents", "descriptions", "folders", "withdrawn"
            return {name: vars(self)[name] for name in names}

    def __setstate__(self, state: Mapping[str, Any]) -> None:
        vars(self).update(state, _lock=threading.RLock(), _cached={})

    def add(self, data: bytes) -> str:
        """Keep a document in memory, and return its id; it is not validated."""
        robot_id = id_of(data)
        with self._lock:
            self.documents[robot_id] = data
        return robot_id

    def add_all(self, other: "RobotLibrary") -> None:
        """Add the documents, descriptions and folders of another library, but not of its base."""
        with self._lock:
            self.documents.update(other.documents)
            self.descriptions.update(other.descriptions)
            self.folders += other.folders
            self.withdrawn |= other.withdrawn

    def describe(self, robot_id: str, about: About) -> None:
        """Set the data of a stored robot beside its document."""
        with self._lock:
            self.descriptions[robot_id] = about

    def about(self, robot_id: str) -> About | None:
        """Return the data of a stored robot beside its document, if there are any."""
        about = self.descriptions.get(robot_id)
        return self._base.about(robot_id) if about is None and self._base is not None else about

    def forget(self, robot_ids: Collection[str]) -> None:
        """Drop documents from memory, and the data beside them; files stay."""
        with self._lock:
            for robot_id in list(robot_ids):
                for values in (self.documents, self._cached, self.descriptions):
                    values.pop(robot_id, None)

    def withdraw(self, folder: Path, robot_ids: Collection[str]) -> None:
        """Find robots of a folder no more, although their files stay."""
        with self._lock:
            self.withdrawn |= {(folder, robot_id) for robot_id in robot_ids}
            self.forget(robot_ids)

    def reinstate(self, folder: Path, robot_ids: Collection[str]) -> None:
        """Find robots of a folder again that were withdrawn."""
        with self._lock:
            self.withdrawn -= {(folder, robot_id) for robot_id in robot_ids}

    def add_folder(self, folder: Path) -> None:
        """Add a folder with files of documents, which may be one folder deeper."""
        with self._lock:
            self.folders.append(folder)

    def remove_folder(self, folder: Path) -> None:
        """Remove a folder; to be called once for each `add_folder`."""
        with self._lock:
            self.folders.remove(folder)
            if folder not in self.folders:
                self.withdrawn = {file for file in self.withdrawn if file[0] != folder}

    def find(self, robot_id: str, name: str | None = None) -> bytes:
        """Return the document of a stored robot.

        Args:
            robot_id: its id.
            name: its name where it was used, for the error.

        Raises:
            InvalidInput: if it is not stored here.
            DamagedFile: if the file is not what was stored.
        """
        if (data := self.get(robot_id)) is None:
            raise InvalidInput(self._unknown(robot_id, name))
        return data

    def get(self, robot_id: str) -> bytes | None:
        """Return the document of a stored robot, None if it is not here.

        Raises:
            DamagedFile: if the file is not what was stored.
        """
        data = self.documents.get(robot_id) or self._cached.get(robot_id)
        if data is None:
            data = self._read(robot_id)
        if data is None and self._base is not None:
            data = self._base.get(robot_id)
        return data

    def _read(self, robot_id: str) -> bytes | None:
        """Return a document from the folders, and keep it among the last that were read."""
        for path in self._paths(robot_id):
            if (path.parent, robot_id) in self.withdrawn:
                continue
            try:
                data = path.read_bytes()
            except OSError:  # it is not there, or not any more
                continue
            if id_of(data) != robot_id:
                raise DamagedFile(f"the file of robot {robot_id} is damaged")
            with self._lock:
                if len(self._cached) >= _MAX_CACHED:
                    self._cached.pop(next(iter(self._cached)))
                self._cached[robot_id] = data
            return data
        return None

    def _paths(self, robot_id: str) -> Iterator[Path]:
        if is_id(robot_id):
            for folder in dict.fromkeys(self.folders):
                yield folder / f"{robot_id}{ENDING}"
                yield from folder.glob(f"*/{robot_id}{ENDING}")

    def names(self) -> dict[str, str]:
        """Return the names of the robots that have one, by id."""
        inherited = {} if self._base is None else self._base.names()
        return inherited | {robot_id: about.name for robot_id, about in self.descriptions.items()}

    def _unknown(self, robot_id: str, name: str | None) -> str:
        label = "" if name is None else f" ({name[:100]})"
        stored = sorted(f"{name} ({robot_id})" for robot_id, name in self.names().items())
        available = "no robot is stored here"
        if stored:
            available = f"stored here: {', '.join(stored[:_MAX_LISTED])}"
        return (
            f"there is no stored robot {str(robot_id)[:40]!r}{label}; import its document or an "
            "archive of a run with it: `hexapods robots import FILE`, POST /api/v1/robots, or "
            f"hx.load_robot(FILE); {available}"
        )


LIBRARY = RobotLibrary()
"""The library of this process, the default wherever a function takes a library."""
