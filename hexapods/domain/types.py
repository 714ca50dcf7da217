"""Basic types shared by all packages."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

Cells = tuple[int, ...]
"""One cell of the foot grid per group of legs: an agent's observation."""


class Action(NamedTuple):
    """Move the feet of one group of legs to one cell of the foot grid; both count from 0."""

    group: int
    cell: int
