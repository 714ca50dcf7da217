"""The agent protocol, which our agents and a user's own implement.

A class whose constructor asks, by the names of its parameters, for what it needs:

- `rng`: a `numpy.random.Generator`, the only source of chance;
- `problem`: what the walking problem looks like (`Problem`);
- `expand`: a simulator to look ahead with (`Expand`); who asks for it is not blind;
- `explore`: False where the agent is evaluated or raced and should do its best;
- a field of the training's config by its name, such as `steps` or `steps_per_episode`.

A parameter that is declared with its limits, title and help (`app.domain.settings`) is a setting:
REST, the command line, the page and sweeps offer it. So is one without a declaration that is named
like a setting of `TabularLearner`, such as `alpha`. Any other keeps its default. Attributes of the
class state the rest:

- `title`, `description`, `color`: how it is shown;
- `learns = False`: practice does not change it;
- `needs_practice = True`: it races only with what it has learned;
- `is_on_policy = True`: it chooses its next action before it learns from the last one, so that a
  changed exploration rate acts a step later.

An agent may have more methods: those of `Tunable`, `Valuing` and `Tabular`, and
`check_state(state)`, a static method that raises `ValueError` or `InvalidInput` for a state that
`load` could not go on from, such as one in a file from elsewhere.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, Protocol, runtime_checkable

from numpy.typing import NDArray

from app.agents.q_table import QTable
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
    next_action: Action | None = None
    """The action that the agent has chosen to take next; only if it `is_on_policy`."""


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
    """An agent whose settings may be changed between two steps.

    A parameter of `tune` that is none of the constructor is a setting too, such as an exploration
    rate that replaces a schedule.
    """

    @property
    def tune(self) -> Callable[..., None]:
        """Change the settings that are given by name, from the next step on."""


@runtime_checkable
class Valuing(Protocol):
    """An agent that can say what it expects of each action."""

    def values(self, observation: Cells) -> FloatArray:
        """(pairs, cells) expected return of moving that pair to that cell; NaN where illegal."""

    def visits(self, observation: Cells) -> FloatArray:
        """(pairs, cells) how often each was tried from here."""


@runtime_checkable
class Tabular(Protocol):
    """An agent whose knowledge is a Q-table, all of it."""

    table: QTable

    def share_table(self, other: Any) -> None:
        """Use the table that another agent of this class writes, to evaluate it without a copy."""

    def continue_from(self, state: AgentState) -> None:
        """Take over what was learned, but neither the settings nor the place in a schedule."""


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
