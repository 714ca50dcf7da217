"""The agent protocol, which our agents and a user's own implement.

A class whose constructor asks, by the names of its parameters, for what it needs:

- `rng`: a `numpy.random.Generator`, the only source of chance;
- `problem`: what the walking problem looks like (`Problem`);
- `expand`: a simulator to look ahead with (`Expand`); who asks for it is not blind;
- `explore`: False where the agent is evaluated or raced and should do its best;
- any further parameter by name, from the settings of the run.

Our learner's parameters are declared with their limits (`app.domain.settings`). An agent that
practice does not change has the attribute `learns = False`.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple, Protocol, runtime_checkable

from numpy.typing import NDArray

from app.domain.types import Action, Cells, FloatArray

AgentState = dict[str, NDArray[Any]]
"""All that an agent needs to go on, as arrays, so that it fits a file."""


class Problem(NamedTuple):
    """The shape of the walking problem that an agent is to solve."""

    pairs: tuple[tuple[int, int], ...]
    """(leader, partner) legs, counted from 1."""
    cells_m: FloatArray
    """Displacement of each cell of the foot grid from home, (cells, 2): x right, y forward."""


class Transition(NamedTuple):
    """One step as the agent observed it; learners learn from it."""

    observation: Cells
    action: Action
    reward_m: float
    next_observation: Cells
    next_legal: Sequence[Action]


@runtime_checkable
class Agent(Protocol):
    """Chooses actions and may learn from what comes of them."""

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        """The action to take now, one of `legal`."""

    def learn(self, transition: Transition) -> None:
        """Take in what came of the last action."""

    def state(self) -> AgentState:
        """A copy of all that was learned and is needed to go on learning."""

    def load(self, state: AgentState) -> None:
        """Go on from what `state` returned."""


@runtime_checkable
class Tunable(Protocol):
    """An agent whose rates may be changed between two steps."""

    def tune(
        self,
        alpha: float | None = None,
        gamma: float | None = None,
        epsilon: float | None = None,
    ) -> None:
        """Change the rates that are given; a given epsilon replaces the schedule."""

    @property
    def epsilon(self) -> float:
        """The probability of a random action at the next step."""


@runtime_checkable
class Valuing(Protocol):
    """An agent that can say what it expects of each action."""

    def values(self, observation: Cells) -> FloatArray:
        """(pairs, cells) expected return of moving that pair to that cell; NaN where illegal."""

    def visits(self, observation: Cells) -> FloatArray:
        """(pairs, cells) how often each was tried from here."""


class Node(Protocol):
    """A future that `Expand` has simulated; opaque but for what can be done there."""

    @property
    def legal(self) -> Sequence[Action]:
        """The actions that are legal there."""


class Expand(Protocol):
    """A simulator for an agent that looks ahead. It counts what it simulates."""

    @property
    def here(self) -> Node:
        """Where the robot is now."""

    def __call__(
        self, nodes: Sequence[Node], actions: Sequence[Action]
    ) -> tuple[Sequence[Node], FloatArray]:
        """Simulate one action from each node: the nodes it leads to, and the rewards [m], (n,)."""
