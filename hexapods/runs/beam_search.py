"""Beam search over a whole walk, plain or with a bonus for the step that comes next.

It knows the simulator, and reads the state without errors. The walks that it finds are possible;
that nothing is better is not proven.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from hexapods.agents.informed import RewardModel
from hexapods.agents.protocol import Problem
from hexapods.domain.observation import legal_in, observe
from hexapods.domain.simulator import Simulator
from hexapods.domain.types import Action, Cells, FloatArray
from hexapods.runs.config import RACE_STEPS

WIDTH = 48
SAME_CELLS = 2
"""Number of walks that the beam keeps among those whose feet are planned to be in the same cells.

Without this limit it fills with copies of one walk: stuck-leg in left-right-vertical came to 0.05 m
instead of 0.27 m.
"""
SIMULATED = 6
"""Steps that are simulated for each walk that the beam with a bonus keeps: about half of them."""


def search(
    simulator: Simulator[Any],
    width: int = WIDTH,
    steps: int = RACE_STEPS,
    *,
    bonus: bool = False,
) -> float:
    """Return the largest distance along the track that a beam search finds [m].

    The beam keeps the walks that have come farthest, layer by layer over all steps; ties go to the
    walk that was found first. It expands them with all their actions.

    With the bonus it ranks them by the distance plus what the next step is predicted to add to it,
    and simulates only the steps that promise most by the same measure, `SIMULATED` for each walk.
    Both predictions are the heuristic of the informed search: the kinematic law, and a residual
    that is learned from all steps that were simulated.

    Args:
        simulator: of the walking problem.
        width: number of walks that are kept after each step.
        steps: number of steps.
        bonus: whether the next step counts.

    Raises:
        Diverged: if the physics diverges.
    """
    model = _NextStep(simulator) if bonus else None
    states = [simulator.rest()]
    for left in reversed(range(steps)):
        branches = [
            (state, action)
            for state in states
            for action in legal_in(simulator, state, observe(simulator, state, "measured"))
        ]
        if model is not None:
            branches = model.most_promising(branches, SIMULATED * width)
        parents, actions = zip(*branches, strict=True)
        ends = simulator.expand(parents, actions).states
        values = _distances(ends)
        if model is not None:
            model.learn(branches, values - _distances(parents))
            if left:
                values = values + model.bonuses(ends)
        states = _keep(simulator, ends, values, width)
    return float(_distances(states).max())


class _NextStep:
    """Predicts what steps add to the distance, and learns it from those that were simulated."""

    def __init__(self, simulator: Simulator[Any]) -> None:
        self._simulator = simulator
        self._model = RewardModel(Problem(simulator.gait.groups, simulator.grid.cells))

    def most_promising(
        self, branches: Sequence[tuple[Any, Action]], count: int
    ) -> list[tuple[Any, Action]]:
        """Return the steps with the highest predicted distance, the one after them included."""
        states, actions = zip(*branches, strict=True)
        gains_m, landed_m = self._model.predict(self._offsets(states), np.array(actions))
        values = _distances(states) + gains_m + self._model.best_rewards(landed_m)
        return [branches[index] for index in np.argsort(-values, kind="stable")[:count].tolist()]

    def bonuses(self, states: Sequence[Any]) -> FloatArray:
        """Return the highest predicted gain of a step from each state [m], (n,)."""
        return self._model.best_rewards(self._offsets(states))

    def learn(self, branches: Sequence[tuple[Any, Action]], gains_m: FloatArray) -> None:
        """Learn from the gains of simulated steps, (n,)."""
        states, actions = zip(*branches, strict=True)
        self._model.learn(self._offsets(states), np.array(actions), gains_m)

    def _offsets(self, states: Sequence[Any]) -> FloatArray:
        by_state = {id(state): self._simulator.group_offsets(state) for state in states}
        return np.array([by_state[id(state)] for state in states])


def _distances(states: Sequence[Any]) -> FloatArray:
    return np.array([state.distance_m for state in states])


def _keep(
    simulator: Simulator[Any], ends: Sequence[Any], values: FloatArray, width: int
) -> list[Any]:
    """Return the states of the highest values, of those with the same planned cells only a few."""
    best: list[Any] = []
    taken: dict[Cells, int] = {}
    for index in np.argsort(-values, kind="stable").tolist():
        cells = tuple(simulator.grid.nearest(x, y) for x, y in ends[index].feet.offsets_m)
        if taken.get(cells, 0) < SAME_CELLS:
            taken[cells] = taken.get(cells, 0) + 1
            best.append(ends[index])
        if len(best) == width:
            break
    return best
