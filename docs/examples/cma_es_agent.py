"""CMA-ES on the parameters of a cyclic gait (Hansen 2016), which tries them on the walking robot.

    hexapods train --gait left-right-origin --agent cma_es_agent:Agent --steps 500 --out cma.npz
    hexapods benchmark cma_es_agent:Agent

Each group has three parameters: a phase, which orders the groups, and the place at which it lands,
rounded to the nearest cell of the grid. A candidate walks two cycles, of which the second counts;
nothing is reset in between. It assumes no simulator and observes nothing: the gait is open loop.
"""

from collections.abc import Sequence

import numpy as np
from cyclic_gait import CyclicGait
from numpy.typing import NDArray

import hexapods as hx

Floats = NDArray[np.float64]


class CmaEs:
    """Covariance matrix adaptation with the default parameters of the tutorial; maximises."""

    def __init__(self, rng: np.random.Generator, size: int) -> None:
        self.rng, self.size, self.count = rng, size, 4 + int(3 * np.log(size))
        weights = np.log(self.count / 2 + 0.5) - np.log(np.arange(1, self.count // 2 + 1))
        self.weights: Floats = weights / weights.sum()
        self.mass = mass = 1 / float((self.weights**2).sum())
        self.c_sigma = (mass + 2) / (size + mass + 5)
        self.damping = 1 + 2 * max(0.0, ((mass - 1) / (size + 1)) ** 0.5 - 1) + self.c_sigma
        self.c_path = (4 + mass / size) / (size + 4 + 2 * mass / size)
        self.c_one = 2 / ((size + 1.3) ** 2 + mass)
        rank_mu = 2 * (mass - 2 + 1 / mass) / ((size + 2) ** 2 + mass)
        self.c_mu = min(1 - self.c_one, rank_mu)
        self.usual = size**0.5 * (1 - 1 / (4 * size) + 1 / (21 * size**2))
        self.mean, self.deviation = np.zeros(size), np.array(0.5)
        self.covariance = np.eye(size)
        self.path, self.path_of_deviation = np.zeros(size), np.zeros(size)

    def ask(self) -> Floats:
        """Return the candidates of a generation, (count, size)."""
        lengths, axes = np.linalg.eigh(self.covariance)
        normal = self.rng.standard_normal((self.count, self.size))
        steps = (normal * np.sqrt(lengths)) @ axes.T
        return np.asarray(self.mean + self.deviation * steps)

    def tell(self, candidates: Floats, values: Floats) -> None:
        """Adapt to the values of a generation, (count,)."""
        best = candidates[np.argsort(-values, kind="stable")[: len(self.weights)]]
        steps = (best - self.mean) / self.deviation
        step = self.weights @ steps
        self.mean = self.mean + self.deviation * step
        lengths, axes = np.linalg.eigh(self.covariance)
        whitened = axes @ ((axes.T @ step) / np.sqrt(lengths))
        kept_share, kept_path = 1 - self.c_sigma, 1 - self.c_path
        self.path_of_deviation = (
            kept_share * self.path_of_deviation
            + (self.mass * (1 - kept_share**2)) ** 0.5 * whitened
        )
        length = float(np.linalg.norm(self.path_of_deviation))
        self.path = kept_path * self.path
        if length < (1.4 + 2 / (self.size + 1)) * self.usual:
            self.path = self.path + (self.mass * (1 - kept_path**2)) ** 0.5 * step
        self.covariance = (
            (1 - self.c_one - self.c_mu) * self.covariance
            + self.c_one * np.outer(self.path, self.path)
            + self.c_mu * (steps.T * self.weights) @ steps
        )
        self.deviation = self.deviation * np.exp(
            self.c_sigma / self.damping * (length / self.usual - 1)
        )


class Agent:
    """Walks candidate by candidate; where it does not explore, as the best of all."""

    title = "CMA-ES"
    description = "Evolves a cyclic gait while it walks."
    needs_practice = True

    def __init__(self, rng: np.random.Generator, problem: hx.Problem, explore: bool = True) -> None:
        self.explore, self.groups = explore, len(problem.groups)
        self.cells = np.asarray(problem.cells_m) / np.abs(problem.cells_m).max()
        self.search = CmaEs(rng, 3 * self.groups)
        self.values = np.zeros(self.search.count)
        self.candidates = self.search.ask()
        self.number = self.step = 0
        self.best, self.best_value = self.candidates[0], np.array(-np.inf)
        self.gait = self.gait_of(self.candidates[0])

    def gait_of(self, parameters: Floats) -> CyclicGait:
        phases, places = parameters[: self.groups], parameters[self.groups :].reshape(-1, 2)
        near = ((places[:, None] - self.cells) ** 2).sum(2).argmin(1)
        order = np.argsort(phases, kind="stable")
        return CyclicGait([hx.Action(int(group), int(near[group])) for group in order])

    def act(self, observation: tuple[int, ...], legal: Sequence[hx.Action]) -> hx.Action:
        return self.gait.act(legal)

    def learn(self, transition: hx.Transition) -> None:
        if self.step >= self.groups:
            self.values[self.number] += transition.reward_m
        self.step += 1
        if self.step < 2 * self.groups:
            return
        if self.values[self.number] > self.best_value:
            self.best = self.candidates[self.number].copy()
            self.best_value = np.array(self.values[self.number])
        self.number, self.step = self.number + 1, 0
        if self.number == len(self.candidates):
            self.search.tell(self.candidates, self.values)
            self.candidates, self.number = self.search.ask(), 0
            self.values = np.zeros(self.search.count)
        self.gait = self.gait_of(self.candidates[self.number])

    def state(self) -> hx.AgentState:
        search = self.search
        return {
            "mean": search.mean.copy(),
            "deviation": np.array(search.deviation),
            "covariance": search.covariance.copy(),
            "path": search.path.copy(),
            "path_of_deviation": search.path_of_deviation.copy(),
            "candidates": self.candidates.copy(),
            "values": self.values.copy(),
            "best": self.best.copy(),
            "best_value": self.best_value.copy(),
            "position": np.array([self.number, self.step, self.gait.next]),
        }

    def load(self, state: hx.AgentState) -> None:
        for name in ("mean", "deviation", "covariance", "path", "path_of_deviation"):
            setattr(self.search, name, state[name].copy())
        for name in ("candidates", "values", "best", "best_value"):
            setattr(self, name, state[name].copy())
        self.number, self.step, next_action = (int(number) for number in state["position"])
        if self.explore:
            self.gait = self.gait_of(self.candidates[self.number])
            self.gait.next = next_action
        else:
            self.gait = self.gait_of(self.best)
