"""Basic types shared by all packages."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

Cells = tuple[int, ...]
"""One cell of the foot grid per leg pair: an agent's observation."""


class Action(NamedTuple):
    """Move the two feet of one pair to one cell of the foot grid; both count from 0."""

    pair: int
    cell: int
