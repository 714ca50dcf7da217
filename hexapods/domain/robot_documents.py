"""Documents of stored robots, by id: in memory, or read from folders when they are asked for.

A document is a robot by value in canonical JSON. Its id is the beginning of its SHA-256, so that
the same robot has the same id everywhere. What people say of it, such as its name, is beside it.
"""

import hashlib
import json
import re
import threading
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

from hexapods.domain.checks import check_format
from hexapods.domain.errors import DamagedFile, InvalidInput, OtherFormat
from hexapods.domain.json_lists import check_lists

ID_DIGITS = 16
FORMAT = "hexapods-robot-1"
MAX_BYTES = 8 << 20
"""Length of a document."""
ENDING = ".json"
"""Of the files in a folder; their names are ids."""
_ID = re.compile(rf"[0-9a-f]{{{ID_DIGITS}}}", re.ASCII)
_lock = threading.RLock()
_added: dict[str, bytes] = {}
_about: dict[str, "About"] = {}
_folders: list[Path] = []
_read: dict[str, bytes] = {}
"""Documents from folders, the last ones that were read."""
_MAX_READ = 16


class About(NamedTuple):
    """Data of a stored robot beside its document.

    Attributes:
        name: by which people know it.
        gait: one that suits it, as in JSON; None if none is known.
    """

    name: str
    gait: Any = None


class RobotDocument(NamedTuple):
    """The document from which a robot was read, and the gait that was stored beside it.

    Attributes:
        data: the document.
        gait: one that suits the robot, as in JSON; None if none is known.
    """

    data: bytes
    gait: Any = None


class Known(NamedTuple):
    """Stored robots that a process knows, to be given to another one.

    Attributes:
        folders: where documents are.
        about: by id.
    """

    folders: tuple[Path, ...]
    about: Mapping[str, About]


def encode(content: Mapping[str, Any]) -> bytes:
    """Return the canonical JSON of a document's content."""
    text = json.dumps({"format": FORMAT, **content}, sort_keys=True, separators=(",", ":"))
    return text.encode()


def decode(data: bytes, label: str = "the document of a robot") -> dict[str, Any]:
    """Return the content of a document, which is not validated.

    Raises:
        OtherFormat: if it is of another version.
        DamagedFile: if it is none in canonical JSON.
    """
    try:
        if len(data) > MAX_BYTES:
            raise ValueError(f"it has more than {MAX_BYTES:,} bytes")
        check_lists(data)
        content: dict[str, Any] = dict(json.loads(data))
        check_format(label, content.pop("format"), FORMAT)
        if encode(content) != data:
            raise ValueError("its JSON is not canonical")
    except OtherFormat:
        raise
    except (ValueError, TypeError, KeyError, RecursionError) as error:
        raise DamagedFile(f"{label} is damaged: {error}") from error
    return content


def id_of(data: bytes) -> str:
    """Return the id of a document."""
    return hashlib.sha256(data).hexdigest()[:ID_DIGITS]


def is_id(text: object) -> bool:
    """Whether a text has the form of an id."""
    return isinstance(text, str) and _ID.fullmatch(text) is not None


def add(data: bytes) -> str:
    """Keep a document in this process, and return its id; it is not validated."""
    robot_id = id_of(data)
    with _lock:
        _added[robot_id] = data
    return robot_id


@contextmanager
def lent(documents: Collection[bytes]) -> Iterator[None]:
    """Keep documents in this process as long as the context lasts, and others as they are."""
    with _lock:
        new = {id_of(data): data for data in documents}
        new = {robot_id: data for robot_id, data in new.items() if robot_id not in _added}
        _added.update(new)
    try:
        yield
    finally:
        with _lock:
            for robot_id in new:
                # What is known beside them stays: a folder may have them too.
                _added.pop(robot_id, None)


def forget(robot_ids: Collection[str]) -> None:
    """Drop documents from memory, and what is known beside them."""
    with _lock:
        for robot_id in list(robot_ids):
            for documents in (_added, _read, _about):
                documents.pop(robot_id, None)


def use_folder(folder: Path) -> None:
    """Read documents from this folder, and from the folders in it, when they are asked for."""
    with _lock:
        _folders.append(folder)


def leave_folder(folder: Path) -> None:
    """Read documents from this folder no longer; to be called once for each `use_folder`."""
    with _lock:
        _folders.remove(folder)


def tell(robot_id: str, about: About) -> None:
    """Set what is known of a stored robot beside its document."""
    with _lock:
        _about[robot_id] = about


def about(robot_id: str) -> About | None:
    """Return what is known of a stored robot beside its document, if anything is."""
    return _about.get(robot_id)


def known() -> Known:
    """Return what another process needs to find the documents that this one finds in folders."""
    with _lock:
        return Known(tuple(dict.fromkeys(_folders)), dict(_about))


def learn(what: Known) -> None:
    """Find the documents, and know what is beside them, as the process that knew this."""
    for folder in what.folders:
        use_folder(folder)
    with _lock:
        _about.update(what.about)


def find(robot_id: str, name: str | None = None) -> bytes:
    """Return the document of a stored robot.

    Args:
        robot_id: its id.
        name: its name where it was used, for the error.

    Raises:
        InvalidInput: if it is not stored here.
        DamagedFile: if it is not what was stored.
    """
    if (data := _added.get(robot_id) or _read.get(robot_id)) is not None:
        return data
    for path in _paths(robot_id):
        try:
            data = path.read_bytes()
        except OSError:  # it is not there, or not any more
            continue
        if id_of(data) != robot_id:
            raise DamagedFile(f"the file of robot {robot_id} is damaged")
        with _lock:
            if len(_read) >= _MAX_READ:
                _read.pop(next(iter(_read)))
            _read[robot_id] = data
        return data
    raise InvalidInput(_not_here(robot_id, name))


def _paths(robot_id: str) -> Iterator[Path]:
    if is_id(robot_id):
        for folder in tuple(_folders):
            yield folder / f"{robot_id}{ENDING}"
            yield from folder.glob(f"*/{robot_id}{ENDING}")


def _not_here(robot_id: str, name: str | None) -> str:
    named = "" if name is None else f" ({name[:100]})"
    stored = sorted(f"{about_robot.name} ({key})" for key, about_robot in _about.items())[:10]
    here = f"stored here: {', '.join(stored)}" if stored else "no robot is stored here"
    return (
        f"there is no stored robot {str(robot_id)[:40]!r}{named}; import its document or an "
        "archive of a run with it: `hexapods robots import FILE`, POST /api/v1/robots, or "
        f"hx.load_robot(FILE); {here}"
    )
