"""How long a test may take: `make soak` sets HEXAPODS_SOAK, and then the promised figures count."""

import os
from typing import TypeVar

T = TypeVar("T")


def at_length(short: T, whole: T) -> T:
    """A figure of the gate's shorter form, or the promised one under `make soak`."""
    return whole if os.environ.get("HEXAPODS_SOAK") else short
