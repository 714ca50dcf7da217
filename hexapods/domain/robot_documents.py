"""The document of a stored robot: the robot by value in canonical JSON.

Its id is the beginning of its SHA-256, so that the same robot has the same id everywhere.
`robot_library` finds documents by their ids.
"""

import hashlib
import json
import re
from collections.abc import Mapping
from typing import Any, NamedTuple

from hexapods.domain.checks import check_format
from hexapods.domain.errors import DamagedFile, OtherFormat
from hexapods.domain.json_lists import check_lists

ID_DIGITS = 16
FORMAT = "hexapods-robot-1"
MAX_BYTES = 8 << 20
"""Maximum length of a document."""
ENDING = ".json"
"""Suffix of the files in a folder, whose names are ids."""
_ID = re.compile(rf"[0-9a-f]{{{ID_DIGITS}}}", re.ASCII)


class RobotDocument(NamedTuple):
    """The document from which a robot was read, and the gait that was stored beside it.

    Attributes:
        data: the document.
        gait: one that suits the robot, as in JSON; None if none is known.
    """

    data: bytes
    gait: Any = None


def encode(content: Mapping[str, Any]) -> bytes:
    """Return the canonical JSON of a document's content."""
    text = json.dumps({"format": FORMAT, **content}, sort_keys=True, separators=(",", ":"))
    return text.encode()


def decode(data: bytes, label: str = "the document of a robot") -> dict[str, Any]:
    """Return the content of a document, which is not validated.

    Raises:
        OtherFormat: if it is of another version.
        DamagedFile: if it is not a document in canonical JSON.
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
