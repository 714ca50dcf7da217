"""What an agent sees: one cell per leg pair, read in one of two ways.

After each step the body re-centres over the feet, so a foot's true offset from home drifts off
the cell it was sent to. The paper does not say which of the two its state holds.
"""

from functools import lru_cache
from itertools import chain
from typing import Literal, get_args

from app.domain.errors import UnknownName
from app.domain.simulator import S, Simulator
from app.domain.types import Action, Cells

Observation = Literal["measured", "commanded"]
"""`measured`: the cell nearest to where the pair's feet are, by forward kinematics.
`commanded`: the cell that the pair was last sent to; aliased, so not Markov."""

OBSERVATIONS: tuple[Observation, ...] = get_args(Observation)


def check_observation(name: str) -> None:
    """Raise `UnknownName` unless this is a way to read the state."""
    if name not in OBSERVATIONS:
        raise UnknownName("observation", name, OBSERVATIONS)


def observe(simulator: Simulator[S], state: S, how: Observation) -> Cells:
    """The cells that an agent sees in this state."""
    if how == "commanded":
        return state.commanded
    nearest = simulator.grid.nearest
    return tuple(nearest(x, y) for x, y in simulator.pair_offsets(state))


@lru_cache(maxsize=1 << 10)
def legal_actions(cells: Cells, cell_count: int) -> tuple[Action, ...]:
    """Every (pair, cell) but the cell that the pair is seen on, pair by pair."""
    parts = [_but(pair, present, cell_count) for pair, present in enumerate(cells)]
    return tuple(chain.from_iterable(parts))


@lru_cache(maxsize=1 << 12)
def _but(pair: int, present: int, cell_count: int) -> tuple[Action, ...]:
    """The actions of a pair that is seen on a cell. States share them: there are many states."""
    every = _every(pair, cell_count)
    return every[:present] + every[present + 1 :]


@lru_cache(maxsize=1 << 7)
def _every(pair: int, cell_count: int) -> tuple[Action, ...]:
    return tuple(Action(pair, cell) for cell in range(cell_count))
