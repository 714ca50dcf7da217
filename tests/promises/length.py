"""Length of a test: the gate's short form, or the promised figures if HEXAPODS_SOAK is set."""

import os
from typing import TypeVar

import pytest

T = TypeVar("T")
_IS_WHOLE = bool(os.environ.get("HEXAPODS_SOAK"))

only_whole = pytest.mark.skipif(not _IS_WHOLE, reason="shown elsewhere; in full by make soak")
"""Marks a test whose short form would show what others in the gate do."""


def at_length(short: T, whole: T) -> T:
    """Return the gate's short figure, or the promised one under `make soak`."""
    return whole if _IS_WHOLE else short
