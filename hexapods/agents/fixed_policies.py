"""Policies that neither learn nor look ahead: a metachronal wave made by hand, and a random walk.

A step of this robot swings one group of legs. With pairs of legs the possible gaits of insects
(Wilson 1966, "Insect walking", Annual Review of Entomology 11) are metachronal waves, in which two
legs swing at a time, pair after pair. With groups of three the wave is the tripod gait.
"""

from collections.abc import Sequence
from typing import Annotated, Literal

import numpy as np

from hexapods.agents.protocol import AgentState, Problem, Transition
from hexapods.domain.settings import Setting
from hexapods.domain.types import Action, Cells

Direction = Annotated[
    Literal["direct", "retrograde"],
    Setting(
        title="Direction",
        help="Direction of the wave. Direct: from back to front, as insects walk; retrograde: from "
        "front to back.",
        choice_titles=("direct", "retrograde"),
        phrase="{}",
    ),
]


_ON_AXIS = 1e-9
"""Largest sine of the azimuth of a leg that counts as straight ahead or behind."""


class Wave:
    """Metachronal wave: swings group after group to the front edge of the foot grid, in turn.

    The order is that of the groups' right legs, from back to front.

    - With mirrored pairs the wave runs along both sides at once. In the wave gait of insects the
      sides are half a cycle apart, and one leg swings at a time.
    - With opposite pairs it runs from back to front on the right, and so the other way on the left.
    - With groups by hand whose left legs follow each other from back to front too, such as (1, 4),
      (5, 3), (6, 2) in a left-right gait, it is the ripple gait with two legs in the air.

    Args:
        problem: groups, foot grid and where the legs are.
        direction: direction of the wave.
    """

    learns = False
    title = "Wave"
    description = "Made by hand: puts group after group of legs forward, from back to front."
    color = "#A6761D"

    def __init__(self, problem: Problem, *, direction: Direction = "direct") -> None:
        self._order = _from_back_to_front(problem)
        if direction == "retrograde":
            self._order.reverse()
        places = [(float(x), float(y)) for x, y in problem.cells_m]
        front = max(y for _, y in places)
        edge = [cell for cell, (_, y) in enumerate(places) if y == front]
        self._front = sorted(edge, key=lambda cell: abs(places[cell][0]))
        self._steps = 0

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:  # noqa: ARG002
        """Return the next group's step to the front, as near to straight ahead as is legal."""
        group = self._order[self._steps % len(self._order)]
        self._steps += 1
        steps = (Action(group, cell) for cell in self._front)
        # Where reach is short, the front may be illegal until other groups have moved.
        return next((step for step in steps if step in legal), legal[0])

    def learn(self, transition: Transition) -> None:
        """Do nothing."""

    def state(self) -> AgentState:
        """Return the number of steps, which determines the next group."""
        return {"steps": np.array([self._steps])}

    def load(self, state: AgentState) -> None:
        """Restore the number of steps."""
        self._steps = int(state["steps"][0])


def _from_back_to_front(problem: Problem) -> list[int]:
    """Return the numbers of the groups, in the order of their right legs from back to front.

    A group on the axis counts by its middle.
    """

    def place_of(group: int) -> float:
        angles = np.deg2rad([problem.azimuths_deg[leg - 1] for leg in problem.groups[group]])
        is_right = np.sin(angles) < -_ON_AXIS
        counted = angles[is_right] if is_right.any() else angles
        return round(float(np.cos(counted).mean()), 9)

    return sorted(range(len(problem.groups)), key=place_of)


class RandomWalk:
    """Takes every legal action with the same probability.

    Args:
        rng: random generator of the walk.
    """

    learns = False
    title = "Random walk"
    description = "Takes any legal step, each with the same chance: what knowing nothing is worth."
    color = "#7F7F7F"

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:  # noqa: ARG002
        """Return a legal action."""
        return legal[int(self._rng.integers(len(legal)))]

    def learn(self, transition: Transition) -> None:
        """Do nothing."""

    def state(self) -> AgentState:
        """Return an empty state: it stores nothing between steps."""
        return {}

    def load(self, state: AgentState) -> None:
        """Do nothing."""
