"""Folders of the dashboard, of its documentation and of the robots' MJCF; styles as they are sent.

Inside the package when it was installed from a wheel, beside it in a checkout.
"""

import re
from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent
_COMMENTS_OF_STYLES = re.compile(rb"/\*.*?\*/\s*", re.DOTALL)


def static_dir() -> Path:
    """The folder of the dashboard's page, styles and scripts."""
    return _find("static")


def docs_dir() -> Path:
    """The folder of the documentation, in Markdown."""
    return _find("docs")


def models_dir() -> Path:
    """The folder of the MJCF files that a robot is put together from."""
    return _find("models")


def without_comments(style: bytes) -> bytes:
    """Return a style sheet without its comments, which no browser needs."""
    return _COMMENTS_OF_STYLES.sub(b"", style)


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
