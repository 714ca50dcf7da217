"""Optional packages: imported when they are first needed, with an error that names the extra."""

import importlib
import os
from typing import Any

from app.domain.errors import InvalidInput


class MissingExtra(InvalidInput):
    """A package of an extra, or of the system, is missing; the message says how to install it."""


def no_opengl(error: Exception) -> MissingExtra:
    """Return the error that OpenGL cannot draw off screen here."""
    backend = os.environ.get("MUJOCO_GL", "")
    by = f" by {backend}" if backend else ""
    return MissingExtra(
        f"a video needs OpenGL, which does not work here{by} ({error}); "
        "on Debian `apt-get install libegl1 libgl1-mesa-dri`, or `apt-get install libosmesa6` "
        "and set MUJOCO_GL=osmesa"
    )


def import_extra(module: str, extra: str, purpose: str) -> Any:
    """Import a module of an extra of this package.

    Args:
        module: its full name.
        extra: a name in `[project.optional-dependencies]` of pyproject.toml.
        purpose: what needs it, as the subject of a sentence in the singular.

    Raises:
        MissingExtra: if it, or a package that it needs, is not installed.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise MissingExtra(
            f"{purpose} needs a package that is not installed here ({error}); "
            f"`pip install 'racing-hexapods[{extra}]'` installs it"
        ) from error
