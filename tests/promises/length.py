"""Length of a test: the gate's short form, or the promised figures if HEXAPODS_SOAK is set."""

import os
from typing import TypeVar

T = TypeVar("T")


def at_length(short: T, whole: T) -> T:
    """Return the gate's short figure, or the promised one under `make soak`."""
    return whole if os.environ.get("HEXAPODS_SOAK") else short
