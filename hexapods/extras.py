"""Optional packages: imported when they are first needed, with an error that names the extra."""

import importlib
import importlib.util
import os
from collections.abc import Mapping
from typing import Any

from hexapods.domain.errors import InvalidInput

_MODULES: Mapping[str, tuple[str, ...]] = {
    "video": ("imageio_ffmpeg", "OpenGL"),
    "parquet": ("pyarrow",),
    "mcap": ("foxglove",),
}
"""Modules that exports need, by the extra that has them."""


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
            f"`{install_command(extra)}` installs it"
        ) from error


def install_command(extra: str) -> str:
    """Return the shell command that installs an extra."""
    return f"pip install 'racing-hexapods[{extra}]'"


def is_installed(extra: str) -> bool:
    """Whether the packages of an extra are installed.

    Nothing is imported; whether OpenGL works only drawing can tell.
    """
    return all(importlib.util.find_spec(module) is not None for module in _MODULES[extra])
