"""An agent of one's own: it remembers what each move from cell to cell has paid on average.

    hexapods train --gait left-right-origin --agent my_agent:Agent --steps 200 --out mine.npz
    hexapods race --gait left-right-origin --lane my_agent:Agent=mine.npz --lane greedy

It forgets which pair moved and where the others stood: 25 numbers instead of 1,500.
"""

from collections.abc import Sequence

import numpy as np

import hexapods as hx


class Agent:
    """Asks, by the names of its parameters, for chance, the problem, and whether to explore."""

    def __init__(self, rng: np.random.Generator, problem: hx.Problem, explore: bool = True) -> None:
        cells = len(problem.cells_m)
        self.rng, self.explore = rng, explore
        self.paid, self.tried = np.zeros((cells, cells)), np.zeros((cells, cells))

    def act(self, observation: tuple[int, ...], legal: Sequence[hx.Action]) -> hx.Action:
        """Mostly the move with the best mean so far; every fifth one by chance while learning."""
        if self.explore and self.rng.random() < 0.2:
            return legal[int(self.rng.integers(len(legal)))]
        mean = self.paid / np.maximum(self.tried, 1)
        return max(legal, key=lambda action: mean[observation[action.group], action.cell])

    def learn(self, transition: hx.Transition) -> None:
        move = transition.observation[transition.action.group], transition.action.cell
        self.paid[move] += transition.reward_m
        self.tried[move] += 1

    def state(self) -> hx.AgentState:
        return {"paid": self.paid.copy(), "tried": self.tried.copy()}

    def load(self, state: hx.AgentState) -> None:
        self.paid[:], self.tried[:] = state["paid"], state["tried"]
