"""A repertoire of gaits and trial and error on the robot (Cully et al. 2015: MAP-Elites, M-BOA).

    hexapods train --gait left-right-origin --agent map_elites_agent:Agent --steps 100 --out map.npz
    hexapods benchmark map_elites_agent:Agent

Before it walks, MAP-Elites fills a map with the best cyclic gait for each way of walking, judged by
a simulator of the intact robot: the law of a step without slip. A gait is a cycle of two moves for
each group, and its way of walking is how often each group moves, and where it lands on average. On
the robot a Gaussian process over the map, whose prior mean are the map's own distances, chooses
which gait to try next. A trial walks two cycles, of which the second counts; nothing is reset.

It assumes a simulator of the robot beforehand, here one without physics, and observes nothing while
it walks: the gait is open loop. `python map_elites_agent.py` measures how long a map takes.
"""

import time
from collections.abc import Sequence
from functools import cache

import numpy as np
from cyclic_gait import CyclicGait
from numpy.typing import NDArray

import hexapods as hx

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

EVALUATIONS, BATCH = 40_000, 500
"""Walks from which a map is made, and of them how many at once."""
CHANCE = 0.15
"""Of each move of a gait to be replaced in a copy, and of its group to be another."""
CURIOSITY, LENGTH, NOISE = 0.05, 0.4, 0.03
"""κ, ρ and σ of the Gaussian process, in shares of the farthest distance in the map."""


class Walks:
    """Walks cyclic gaits by the law of a step without slip, many at once."""

    def __init__(self, shares: Floats, cells: Floats) -> None:
        self.shares, self.cells = shares, cells

    def distances(self, gaits: Integers) -> Floats:
        """Return the mean advance a move of gaits (n, moves, 2), in cycles 3 to 6, (n,)."""
        count, moves, _ = gaits.shape
        rows, offsets = np.arange(count), np.zeros((count, len(self.shares), 2))
        total, taken = np.zeros(count), np.zeros(count)
        for number in range(6 * moves):
            group, cell = gaits[:, number % moves].T
            near = ((offsets[rows, group][:, None] - self.cells) ** 2).sum(2).argmin(1)
            is_legal = near != cell
            place = np.where(is_legal[:, None], self.cells[cell], offsets[rows, group])
            offsets[rows, group] = place
            advance = np.where(is_legal, (offsets[:, :, 1] * self.shares).mean(1), 0.0)
            offsets[:, :, 1] -= advance[:, None]
            if number >= 2 * moves:  # before, it still depends on the start
                total, taken = total + advance, taken + is_legal
        return np.asarray(total / np.maximum(taken, 1))

    def descriptors(self, gaits: Integers) -> Floats:
        """Return the way of walking: of each group its turns, and mean place, (n, 3 groups)."""
        group, cell = gaits[:, :, 0], gaits[:, :, 1]
        is_of = np.arange(len(self.shares))[:, None] == group[:, None]  # (n, groups, moves)
        turns = is_of.sum(2)
        places = np.einsum("ngm,nmx->ngx", is_of.astype(float), self.cells[cell])
        places = places / np.maximum(turns, 1)[:, :, None]
        return np.concatenate([turns / 2, places.reshape(len(gaits), -1)], axis=1)


@cache
def repertoire(shares: tuple[float, ...], cells: tuple[float, ...]) -> tuple[Integers, Floats]:
    """Return the gaits of a map, (n, moves, 2), and their advances a move, (n,); made once."""
    rng, groups = np.random.default_rng(0), len(shares)
    walks = Walks(np.array(shares), np.array(cells).reshape(-1, 2))
    elites: dict[tuple[int, ...], tuple[float, Integers]] = {}
    for number in range(EVALUATIONS // BATCH):
        fresh = np.stack(
            [
                rng.integers(groups, size=(BATCH, 2 * groups)),
                rng.integers(len(walks.cells), size=(BATCH, 2 * groups)),
            ],
            axis=2,
        )
        gaits = fresh
        if number > 0:
            some = list(elites.values())
            parents = np.array([some[index][1] for index in rng.integers(len(some), size=BATCH)])
            is_new = rng.random(gaits.shape) < CHANCE
            gaits = np.where(is_new, fresh, parents)
        niches = np.rint(2 * walks.descriptors(gaits)).astype(int).tolist()
        for gait, far, niche in zip(gaits, walks.distances(gaits), niches, strict=True):
            if far > elites.get(tuple(niche), (-np.inf,))[0]:
                elites[tuple(niche)] = float(far), gait
    chosen = [elite for elite in elites.values() if elite[0] > 0]
    return np.array([gait for _, gait in chosen]), np.array([far for far, _ in chosen])


class Agent:
    """Tries gaits of the map while it learns; frozen, it walks the one that it trusts most."""

    title = "MAP-Elites"
    description = "Tries gaits of a repertoire that a simulation of the intact robot has made."
    needs_practice = True

    def __init__(self, problem: hx.Problem, explore: bool = True) -> None:
        unit = float(np.abs(problem.cells_m).max())
        cells = np.asarray(problem.cells_m) / unit
        shares = tuple(float(share) for share in problem.shares)
        self.gaits, expected = repertoire(shares, tuple(float(x) for x in cells.ravel()))
        self.unit = float(expected.max()) * unit
        self.expected = expected / expected.max()
        self.places = Walks(np.array(shares), cells).descriptors(self.gaits)
        self.explore, self.moves = explore, self.gaits.shape[1]
        self.tried, self.values = np.zeros(0, int), np.zeros(0)
        self.across = np.zeros((len(expected), 0))
        self.start()

    def start(self) -> None:
        """Begin the trial of the gait that promises most, or of the one to rely on."""
        mean, deviation = self.posterior()
        self.number = int((mean + CURIOSITY * deviation * self.explore).argmax())
        self.gait = CyclicGait([hx.Action(*map(int, move)) for move in self.gaits[self.number]])
        self.step, self.earned = 0, 0.0

    def posterior(self) -> tuple[Floats, Floats]:
        """Return mean and deviation of the Gaussian process at each gait of the map, (n,)."""
        if not len(self.tried):
            return self.expected, np.ones(len(self.expected))
        new = self.places[self.tried[self.across.shape[1] :]]
        self.across = across = np.hstack([self.across, _similarity(self.places, new)])
        among = across[self.tried] + NOISE**2 * np.eye(len(self.tried))
        gains = np.linalg.solve(among, across.T).T
        mean = self.expected + gains @ (self.values - self.expected[self.tried])
        return mean, np.sqrt(np.maximum(1 - (gains * across).sum(1), 0.0))

    def act(self, observation: tuple[int, ...], legal: Sequence[hx.Action]) -> hx.Action:
        return self.gait.act(legal)

    def learn(self, transition: hx.Transition) -> None:
        self.step += 1
        self.earned += transition.reward_m * (self.step > self.moves)
        if self.step == 2 * self.moves:
            self.tried = np.append(self.tried, self.number)
            self.values = np.append(self.values, self.earned / self.moves / self.unit)
            self.start()

    def state(self) -> hx.AgentState:
        position = np.array([self.number, self.step, self.gait.next])
        trial = {"position": position, "earned": np.array(self.earned)}
        return {"tried": self.tried.copy(), "values": self.values.copy(), **trial}

    def load(self, state: hx.AgentState) -> None:
        self.tried, self.values = state["tried"].astype(int), state["values"].copy()
        self.start()
        if self.explore:
            self.number, self.step, next_move = (int(number) for number in state["position"])
            self.gait = CyclicGait([hx.Action(*map(int, move)) for move in self.gaits[self.number]])
            self.gait.next, self.earned = next_move, float(state["earned"])


def _similarity(ways_a: Floats, ways_b: Floats) -> Floats:
    """Return Matérn 5/2 kernels of ways of walking, (n, m)."""
    distance = np.sqrt(((ways_a[:, None] - ways_b) ** 2).mean(2)) / LENGTH
    scaled = 5**0.5 * distance
    return np.asarray((1 + scaled + scaled**2 / 3) * np.exp(-scaled))


def main() -> None:
    for name, groups in {"three pairs": 3, "tripod": 2, "six legs one by one": 6}.items():
        start = time.perf_counter()
        cells = ((0, 0), (-1, 1), (1, 1), (-1, -1), (1, -1))
        gaits, far = repertoire((1.0,) * groups, tuple(float(x) for cell in cells for x in cell))
        took = time.perf_counter() - start
        print(f"{name}: {len(gaits):,} gaits in {took:.1f} s, the best {far.max():.3f} h a move")


if __name__ == "__main__":
    main()
