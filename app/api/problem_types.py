"""The types of problems: what a client can branch on, with a page that describes each.

The type is the path `/problems/NAME`, below the address of the server, and the same on every one.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

from app.storage.errors import (
    Busy,
    Conflict,
    Damaged,
    Forbidden,
    Gone,
    NotAnswering,
    NotFound,
    StorageFailed,
    StorageFull,
)
from hexapods.domain.errors import (
    DamagedFile,
    HexapodError,
    ImpossibleLegs,
    InvalidInput,
    TableMismatch,
    UnknownName,
)

FOLDER = "/problems/"


class ProblemType(NamedTuple):
    """A type of problem.

    Attributes:
        status: HTTP status of the answers.
        title: what went wrong, in a few words.
        remedy: what a client can do about it.
    """

    status: int
    title: str
    remedy: str


TYPES: Mapping[str, ProblemType] = MappingProxyType(
    {
        "malformed-request": ProblemType(
            400, "The request cannot be read", "Send well-formed HTTP, and valid JSON."
        ),
        "operator-needed": ProblemType(
            401, "It needs the operator", "Send the server's token: Authorization: Bearer …"
        ),
        "forbidden": ProblemType(
            403, "It is not open to this client", "The detail says why, and who may do it."
        ),
        "foreign-request": ProblemType(
            403,
            "The request comes from a foreign page, or calls the server by a foreign name",
            "Call the server by a name of its own; its operator can name further hosts "
            "(HEXAPODS_ALLOWED_HOSTS) and origins (HEXAPODS_CORS_ORIGINS).",
        ),
        "not-found": ProblemType(
            404, "There is no such thing", "It was never there, or was deleted: list what there is."
        ),
        "method-not-allowed": ProblemType(
            405, "The method is not possible here", "The header Allow lists those that are."
        ),
        "conflict": ProblemType(
            409,
            "It cannot be done in the present state",
            "The member state is the run's: wait until it has another one.",
        ),
        "damaged-run": ProblemType(
            409, "A stored run cannot be read", "Delete it, or restore a backup."
        ),
        "gone": ProblemType(
            410, "It was deleted", "Start again, with another Idempotency-Key if it was a start."
        ),
        "body-too-large": ProblemType(
            413, "The request's body is too large", "Send less; the detail has the limit."
        ),
        "target-too-long": ProblemType(
            414, "The address is too long", "Send less in the query; the detail has the limit."
        ),
        "unsupported-media-type": ProblemType(
            415, "The body's type is not taken here", "Send application/json, or what /docs names."
        ),
        "invalid-input": ProblemType(
            422,
            "A value cannot be",
            "The member errors lists all fields that are wrong by themselves, each with what is "
            "valid; field names one that does not fit others.",
        ),
        "unknown-name": ProblemType(
            422, "A name is not known", "The detail lists the names that there are."
        ),
        "impossible-legs": ProblemType(
            422, "The legs of a robot cannot be so", "The member legs has the numbers of the legs."
        ),
        "table-mismatch": ProblemType(
            422,
            "A table was learned for another walk",
            "Take a table of the same robot, gait and grid, or train one.",
        ),
        "damaged-file": ProblemType(
            422, "A file is damaged, or of another format", "Make or fetch it again."
        ),
        "too-many-requests": ProblemType(
            429, "It is too much at once", "Try again after the seconds of the header Retry-After."
        ),
        "headers-too-large": ProblemType(
            431, "The request's headers are too large", "Send shorter ones, such as fewer cookies."
        ),
        "server-error": ProblemType(
            500, "Something broke in the server", "Its log says what; other runs go on."
        ),
        "unavailable": ProblemType(
            503,
            "The server cannot do it at the moment",
            "Try again later: after the seconds of the header Retry-After, if there is one.",
        ),
        "storage-full": ProblemType(
            507, "There is no room for what is to be kept", "Delete runs, or raise the quota."
        ),
    }
)
"""By the last part of the path. None is ever renamed; the first of a status is that of an answer
which says nothing closer."""
_OF_ERRORS: Mapping[type[HexapodError], str] = {
    UnknownName: "unknown-name",
    ImpossibleLegs: "impossible-legs",
    TableMismatch: "table-mismatch",
    DamagedFile: "damaged-file",
    InvalidInput: "invalid-input",
    Forbidden: "forbidden",
    NotFound: "not-found",
    Gone: "gone",
    Damaged: "damaged-run",
    Conflict: "conflict",
    Busy: "too-many-requests",
    StorageFull: "storage-full",
    StorageFailed: "unavailable",
    NotAnswering: "unavailable",
}
"""By class of error, subclasses first."""


def type_of_error(error: Exception) -> str | None:
    """Return the name of an error's type; None for one that is a defect of the server."""
    return next((name for kind, name in _OF_ERRORS.items() if isinstance(error, kind)), None)


def type_of_status(status: int) -> str | None:
    """Return the name of the type of a status that says nothing closer; None if it has none."""
    return next((name for name, kind in TYPES.items() if kind.status == status), None)
