"""Length of a test: its short form, or the promised figures if HEXAPODS_SOAK is set."""

import os
from typing import TypeVar

import pytest

T = TypeVar("T")
IS_WHOLE = bool(os.environ.get("HEXAPODS_SOAK"))

only_whole = pytest.mark.soak
"""Marks a test whose short form would show what others do; `tests/tiers.py` skips it elsewhere."""


def at_length(short: T, whole: T) -> T:
    """Return the short figure, or the promised one under `make soak`."""
    return whole if IS_WHOLE else short
