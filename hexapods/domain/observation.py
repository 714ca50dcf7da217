"""Observations of an agent, one cell per group of legs in three readings; and the legal actions.

After each step the body re-centres over the feet, so a foot's actual offset from home drifts from
its commanded cell. The paper does not say which of the two its state holds. Dead reckoning is in
between: it follows the drift, but from the commands alone.
"""

from collections.abc import Sequence
from functools import lru_cache
from itertools import chain
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from hexapods.domain.errors import UnknownName
from hexapods.domain.simulator import S, Simulator
from hexapods.domain.types import Action, Cells, FloatArray

Observation = Literal["measured", "commanded", "planned"]
"""`measured`: the cell nearest to where the group's feet are, by forward kinematics.
`commanded`: the cell that the group was last sent to; aliased, so not Markov.
`planned`: the cell nearest to where the group's feet would be if nothing had slipped or given way
(dead reckoning from the commands); it does not depend on sensors, nor on how a leg really moved."""

OBSERVATIONS: tuple[Observation, ...] = get_args(Observation)
PAPER_OBSERVATIONS: tuple[Observation, ...] = ("measured", "commanded")
"""The observations that the paper may have meant; its experiments are repeated with both."""


def check_observation(name: str) -> None:
    """Check that an observation exists.

    Raises:
        UnknownName: if it does not.
    """
    if name not in OBSERVATIONS:
        raise UnknownName("observation", name, OBSERVATIONS)


def observe(
    simulator: Simulator[S], state: S, how: Observation, error_m: FloatArray | None = None
) -> Cells:
    """Return the cells that an agent observes in a state, one per group.

    Args:
        simulator: simulates the robot.
        state: state of the robot.
        how: observation mode.
        error_m: errors of the measured offsets, (groups, 2) [m]; None for none.
    """
    if how == "commanded":
        return state.commanded
    nearest = simulator.grid.nearest
    if how == "planned":
        return tuple(nearest(x, y) for x, y in state.feet.offsets_m)
    return tuple(nearest(x, y) for x, y in measured_offsets(simulator, state, error_m))


def measured_offsets(
    simulator: Simulator[S], state: S, error_m: FloatArray | None = None
) -> Sequence[tuple[float, float]]:
    """Return the measured offset (x, y) of each group from home [m].

    Args:
        simulator: simulates the robot.
        state: state of the robot.
        error_m: errors of measurement, (groups, 2) [m]; None for none.
    """
    offsets = simulator.group_offsets(state)
    if error_m is None:
        return offsets
    return [(x + dx, y + dy) for (x, y), (dx, dy) in zip(offsets, error_m.tolist(), strict=True)]


def legal_in(simulator: Simulator[S], state: S, observed: Cells) -> Sequence[Action]:
    """Return the legal actions in a state, in which an agent observes these cells.

    Those that lead a foot out of reach are not legal.
    """
    return simulator.law.possible(state.feet, legal_actions(observed, len(simulator.grid)))


def action_mask(legal: Sequence[Action], groups: int, cells: int) -> NDArray[np.bool_]:
    """Return whether each action is legal, by its number in Gymnasium: group × cells + cell."""
    mask = np.zeros((groups, cells), bool)
    mask[tuple(np.transpose(legal))] = True
    return mask.ravel()


@lru_cache(maxsize=1 << 10)
def legal_actions(cells: Cells, cell_count: int) -> tuple[Action, ...]:
    """Return all legal actions, group by group: every cell but the group's observed one."""
    by_group = (_actions_except(group, present, cell_count) for group, present in enumerate(cells))
    return tuple(chain.from_iterable(by_group))


@lru_cache(maxsize=1 << 12)
def _actions_except(group: int, present: int, cell_count: int) -> tuple[Action, ...]:
    """Return a group's actions except the one to its observed cell; cached, shared by states."""
    every = _all_actions(group, cell_count)
    return every[:present] + every[present + 1 :]


@lru_cache(maxsize=1 << 7)
def _all_actions(group: int, cell_count: int) -> tuple[Action, ...]:
    return tuple(Action(group, cell) for cell in range(cell_count))
