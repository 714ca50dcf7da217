"""Versions of the software that a trial's result depends on."""

import platform
from collections.abc import Mapping
from importlib.metadata import version

from app import __version__


def versions() -> dict[str, str]:
    """Return the versions of the product, Python, NumPy and MuJoCo in this process."""
    return {
        "racing-hexapods": __version__,
        "python": platform.python_version(),
        "numpy": version("numpy"),
        "mujoco": version("mujoco-core"),
    }


def difference(here: Mapping[str, str], there: Mapping[str, str]) -> str | None:
    """Describe how the versions of two processes differ; None if results are comparable.

    Python's patch version is ignored.
    """
    names = [name for name in here if _comparable(here, name) != _comparable(there, name)]
    if not names:
        return None
    return ", ".join(f"{name} {there.get(name, 'none')} instead of {here[name]}" for name in names)


def _comparable(installed: Mapping[str, str], name: str) -> str | None:
    value = installed.get(name)
    return value.rpartition(".")[0] if name == "python" and value else value
