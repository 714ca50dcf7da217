"""Sums of floats, with the same bits in every Python.

Since Python 3.12 the built-in `sum` compensates the rounding errors of floats, so that its last bit
differs from that of 3.11. `tests/domain/test_sums.py` refuses it for all but whole numbers.
"""

from collections.abc import Iterable
from functools import reduce
from operator import add
from typing import TypeVar, overload

from hexapods.domain.types import FloatArray

T = TypeVar("T", float, FloatArray)


@overload
def ordered_sum(numbers: Iterable[float]) -> float: ...


@overload
def ordered_sum(numbers: Iterable[T], start: T) -> T: ...


def ordered_sum(numbers: Iterable[T], start: T | float = 0.0) -> T | float:
    """Return the sum of numbers or arrays, added one after the other, each sum rounded."""
    return reduce(add, numbers, start)
