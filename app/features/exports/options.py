"""What the options say of the files of a recorded walk."""

from typing import Literal

from app.answer import Answer
from hexapods.exports.registry import EXPORTS


class ExportOption(Answer):
    """A type of file that a race or training which has ended can be exported as.

    Attributes:
        address: below `/api/v1/runs/{run_id}/`.
        method: of the request; POST is for operators only.
        install: the command that installs what the server lacks; null if it lacks nothing.
    """

    title: str
    address: str
    method: Literal["GET", "POST"]
    ending: str
    install: str | None


def export_options() -> list[dict[str, str | None]]:
    """Return the files of a recorded walk, in plain types as of `ExportOption`."""
    return [
        {
            "title": file.title,
            "address": export.address(name, file),
            "method": export.method,
            "ending": file.ending,
            "install": file.install,
        }
        for name, export in EXPORTS.items()
        for file in export.files
    ]
