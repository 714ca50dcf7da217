"""Folders of the dashboard, of its documentation and of the robots' MJCF; files as they are sent.

Inside the package when it was installed from a wheel, beside it in a checkout.
"""

import re
from pathlib import Path, PurePath

_PACKAGE = Path(__file__).resolve().parent
_OF_OTHERS = "vendor"
"""Folder of scripts of other projects, whose comments are their licences."""
_COMMENTS_OF_STYLES = re.compile(rb"/\*.*?\*/\s*", re.DOTALL)
_COMMENT_LINES = re.compile(rb"^[ \t]*(?://[^\n]*|/\*(?:[^*]|\*(?!/))*\*/[ \t]*)$", re.MULTILINE)
"""Comments of a script that have their lines to themselves."""


def static_dir() -> Path:
    """The folder of the dashboard's page, styles and scripts."""
    return _find("static")


def docs_dir() -> Path:
    """The folder of the documentation, in Markdown."""
    return _find("docs")


def models_dir() -> Path:
    """The folder of the MJCF files that a robot is put together from."""
    return _find("models")


def as_sent(path: PurePath, content: bytes) -> bytes:
    """Return a file below `static` without the comments that no browser needs.

    A quarter of what a page transfers are comments. In scripts they leave empty lines, so that an
    error names the line that the file has; those behind a statement stay.
    """
    if path.suffix == ".css":
        return _COMMENTS_OF_STYLES.sub(b"", content)
    if path.suffix == ".js" and _OF_OTHERS not in path.parts:
        return _COMMENT_LINES.sub(lambda match: b"\n" * match[0].count(b"\n"), content)
    return content


def _find(name: str) -> Path:
    in_wheel = _PACKAGE / f"_{name}"
    in_checkout = _PACKAGE.parent / name
    # The wheel's own first: beside an installed package, `static` could be anyone's.
    for folder in (in_wheel, in_checkout):
        if folder.is_dir():
            return folder
    raise FileNotFoundError(
        f"This installation of Racing Hexapods is incomplete: neither {in_wheel} nor "
        f"{in_checkout} exists. Install it again."
    )
