"""Extras: optional packages, with an error that says the line which installs them.

A module of an extra is imported under `needs`, and nowhere else, which a test checks:

    with needs("parquet", "a Parquet file"):
        import pyarrow as arrow
"""

import importlib.util
import os
import shutil
import sys
import sysconfig
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from hexapods.domain.errors import InvalidInput

MODULES: Mapping[str, tuple[str, ...]] = {
    "cluster": ("distributed",),
    "figures": ("matplotlib",),
    "gym": ("gymnasium",),
    "mcap": ("foxglove",),
    "mcp": ("mcp",),
    "parquet": ("pyarrow",),
    "postgres": ("psycopg",),
    "video": ("imageio_ffmpeg", "OpenGL"),
}
"""Modules that the product imports, by the extra of pyproject.toml that has them."""


class MissingExtra(InvalidInput):
    """A package of an extra, or of the system, is missing; the message says how to install it."""


@contextmanager
def needs(extra: str, purpose: str) -> Iterator[None]:
    """Turn an `ImportError` within the context into a `MissingExtra`.

    Args:
        extra: name of the extra in `[project.optional-dependencies]` of pyproject.toml.
        purpose: what needs it, as the subject of a sentence in the singular.

    Raises:
        MissingExtra: if a package of the extra, or one that it needs, is not installed.
    """
    try:
        yield
    except ImportError as error:
        raise _missing(extra, purpose, error) from error


def _missing(extra: str, purpose: str, reason: object) -> MissingExtra:
    return MissingExtra(
        f"{purpose} needs a package that is not installed here ({reason}); "
        f"`{install_command(extra)}` installs it"
    )


def install_command(*extras: str) -> str:
    """Return the shell command that installs extras into the environment of this process.

    It is the same in a checkout as with a package from an index: what is installed already is not
    looked for there. Its quotes are those of every shell.

    Raises:
        InvalidInput: if there is no such extra; the message names those that there are.
    """
    if unknown := [extra for extra in extras if extra not in MODULES]:
        raise InvalidInput(f"there is no extra {unknown[0]!r}; the extras are {', '.join(MODULES)}")
    package = f'"racing-hexapods[{",".join(extras)}]"'
    if importlib.util.find_spec("pip") is not None:
        return f"{_pip()} install {package}"
    # An environment of uv, which has no pip.
    prefix = Path(sys.prefix)
    if (prefix / "uv-receipt.toml").is_file():
        return f"uv tool install {package}"
    if any((folder / "CACHEDIR.TAG").is_file() for folder in prefix.parents):
        return f"uvx --from {package} racing-hexapods"
    return f"uv pip install {package}"


def _pip() -> str:
    """Return the command of this environment's pip.

    It has its folder where the shell would find another pip, or none, and the environment is below
    the working directory: as in a checkout after `make run`. Else it has none: errors are shown to
    whoever asks a server, and must not name its folders.
    """
    scripts = Path(sysconfig.get_path("scripts"))
    command = shutil.which("pip")
    is_found = command is not None and Path(command).parent.resolve() == scripts.resolve()
    if is_found or not scripts.is_relative_to(Path.cwd()):
        return "pip"
    return str(scripts.relative_to(Path.cwd()) / "pip")


def is_installed(extra: str) -> bool:
    """Whether the packages of an extra are installed.

    Nothing is imported; whether OpenGL works only drawing can tell.
    """
    return all(importlib.util.find_spec(module) is not None for module in MODULES[extra])


def no_opengl(error: Exception) -> MissingExtra:
    """Return the error that OpenGL cannot draw off screen here."""
    backend = os.environ.get("MUJOCO_GL", "")
    by = f" by {backend}" if backend else ""
    return MissingExtra(
        f"a video needs OpenGL, which does not work here{by} ({error}); "
        "on Debian `apt-get install libegl1 libgl1-mesa-dri`, or `apt-get install libosmesa6` "
        "and set MUJOCO_GL=osmesa"
    )
