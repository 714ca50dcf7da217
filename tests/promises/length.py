"""How long a test may take: `make soak` sets HEXAPODS_SOAK, and then the promised figures count."""

import os
from typing import TypeVar

import pytest

T = TypeVar("T")

only_in_the_soak = pytest.mark.skipif(
    not os.environ.get("HEXAPODS_SOAK"), reason="the gate shows it in a shorter way"
)


def at_length(short: T, whole: T) -> T:
    """A figure of the gate's shorter form, or the promised one under `make soak`."""
    return whole if os.environ.get("HEXAPODS_SOAK") else short
