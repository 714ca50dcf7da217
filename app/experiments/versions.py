"""What a result depends on beside its config."""

import platform
from collections.abc import Mapping
from importlib.metadata import version

from app import __version__


def versions() -> dict[str, str]:
    """The product, Python, and what it computes with, as they are in this process."""
    return {
        "racing-hexapods": __version__,
        "python": platform.python_version(),
        "numpy": version("numpy"),
        "mujoco": version("mujoco-core"),
    }


def difference(here: Mapping[str, str], there: Mapping[str, str]) -> str | None:
    """What makes results of two places differ, in words; None where they are the same.

    Python's last number counts for nothing.
    """
    names = [name for name in here if _that_counts(here, name) != _that_counts(there, name)]
    if not names:
        return None
    return ", ".join(f"{name} {there.get(name, 'none')} instead of {here[name]}" for name in names)


def _that_counts(found: Mapping[str, str], name: str) -> str | None:
    value = found.get(name)
    return value.rpartition(".")[0] if name == "python" and value else value
