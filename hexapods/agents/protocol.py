"""Agent protocol: the interface of all agents, built-in and user-supplied.

An agent is a class. Its constructor's parameters are passed by name (dependency injection):

- `rng`: a `numpy.random.Generator`, the only source of randomness;
- `problem`: the size and geometry of the walking problem (`Problem`);
- `expand`: a simulator for look-ahead (`Expand`);
- `observe`: reads the current state in other ways than the run's observation (`Observe`);
- `explore`: False where the agent should not explore: in evaluations, and in races unless its lane
  keeps learning;
- a field of the training's config by its name, such as `steps` or `steps_per_episode`.

A parameter that is declared with its limits, title and help (`hexapods.domain.settings`) is a
setting: REST, the command line, the page and sweeps offer it. So is one without a declaration that
is named like a setting of `TabularLearner`, such as `alpha`. Any other keeps its default.
Attributes of the class declare:

- `title`, `description`, `color`: its appearance;
- `learns = False`: practice does not change it;
- `needs_practice = True`: it races only with what it has learned, or learning in the race;
- `keeps_learning = True`: in a race it keeps learning, unless the lane says otherwise;
- `is_memoryless = True`, not inherited: a decision follows from the present state alone, so that a
  race that repeats another's first steps need not make it again;
- `is_on_policy = True`: it chooses its next action before it learns from the last one, so that a
  changed exploration rate acts a step later.

Optional methods: those of `Tunable`, `Teachable`, `Valuing` and `Tabular`, of `Explaining` and
`ExplainingSearch` in `hexapods.agents.explanation`, and three static methods:
`check_state(state)` raises `ValueError`, which `InvalidInput` is, for a state that `load` cannot
restore, such as one in an untrusted file; `check_problem(problem, **settings)` raises
`InvalidInput` for settings that are too much for a problem, before a run is queued;
`check_unattended(**settings)` for those with which it learns nothing unless people teach it.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from hexapods.agents.value_table import ValueTable
from hexapods.domain.observation import Observation
from hexapods.domain.types import Action, Cells, FloatArray

AgentState = dict[str, NDArray[Any]]
"""Complete state of an agent as named arrays, for checkpoint files."""


class Observe(Protocol):
    """Observations of the current state: before the action in `act`, after it in `learn`."""

    def __call__(self, how: Observation) -> Cells:
        """Return the observed cells, one per group."""

    @property
    def planned_offsets_m(self) -> Sequence[tuple[float, float]]:
        """Each group's offset (x, y) from home by dead reckoning: `planned` before rounding."""

    @property
    def heading_rad(self) -> float:
        """Angle by which the torso has turned since the start, anticlockwise [rad]: 0 ahead."""


class Problem(NamedTuple):
    """Size and geometry of the walking problem."""

    groups: tuple[tuple[int, ...], ...]
    """Legs that move together, counted from 1."""
    cells_m: FloatArray
    """Displacement of each cell of the foot grid from home, (cells, 2): x right, y forward."""
    azimuths_deg: tuple[float, ...] = ()
    """Each leg's azimuth relative to forward, anticlockwise; empty if unknown."""

    @property
    def shares(self) -> FloatArray:
        """Number of legs of each group, as a share of their mean number, (groups,).

        The mean over all feet is that over groups weighted by these; exactly 1 for equal groups.
        """
        sizes = np.array([len(group) for group in self.groups], float)
        return np.asarray(sizes / sizes.mean())


class Transition(NamedTuple):
    """Transition (s, a, r, s′) of one step, as observed by the agent."""

    observation: Cells
    action: Action
    reward_m: float
    next_observation: Cells
    next_legal: Sequence[Action]
    next_action: Action | None = None
    """Next action that the agent has chosen; only if it `is_on_policy`."""


class Press(NamedTuple):
    """A press of + or − by who watches the walk."""

    at_step: float
    """Number of steps that were done in the picture then, with the share of the present one."""
    value: float
    """From −1 to 1: of several who press for the same moment, their mean."""


@runtime_checkable
class Agent(Protocol):
    """Interface of an agent: chooses actions, and may learn from transitions."""

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        """Return the action to take, one of `legal`."""

    def learn(self, transition: Transition) -> None:
        """Learn from the transition of the last action."""

    def state(self) -> AgentState:
        """Return a copy of the complete state, for a checkpoint."""

    def load(self, state: AgentState) -> None:
        """Restore a state that `state` returned."""


@runtime_checkable
class Tunable(Protocol):
    """Agent whose settings may be changed between two steps.

    A parameter of `tune` that the constructor does not have is a setting too, such as an
    exploration rate that replaces a schedule.
    """

    @property
    def tune(self) -> Callable[..., None]:
        """Change settings, given by name, from the next step on."""


@runtime_checkable
class Teachable(Protocol):
    """Agent that learns from presses of + and − by who watches it, between two steps."""

    def feel(self, presses: Sequence[Press]) -> None:
        """Learn from presses, in this order."""


@runtime_checkable
class Valuing(Protocol):
    """Agent that exposes its action values and visit counts."""

    def values(self, observation: Cells) -> FloatArray:
        """Return action values [m], (groups, cells): expected return; NaN where illegal."""

    def visits(self, observation: Cells) -> FloatArray:
        """Return visit counts of the actions in this state, (groups, cells)."""


@runtime_checkable
class Tabular(Protocol):
    """Agent whose greedy policy follows from a table; its state may hold more than that.

    Its `state` includes the table as its `dump` returns it.
    """

    table: ValueTable

    def share_table(self, other: Any) -> None:
        """Share the table of another agent of this class, to evaluate it without a copy."""

    def continue_from(self, state: AgentState) -> None:
        """Load the learned values of a saved state, but not its settings or schedule position."""


class Node(Protocol):
    """Node of a search tree: a simulated state, with its legal actions and foot offsets."""

    @property
    def legal(self) -> Sequence[Action]:
        """The legal actions in this state."""

    @property
    def offsets_m(self) -> Sequence[tuple[float, float]]:
        """Measured offset (x, y) of each group from home, in the robot frame [m]."""


class Expand(Protocol):
    """Simulator for look-ahead, which counts the transitions that it simulates."""

    @property
    def here(self) -> Node:
        """Root node: the current state of the robot."""

    def __call__(
        self, nodes: Sequence[Node], actions: Sequence[Action]
    ) -> tuple[Sequence[Node], FloatArray]:
        """Simulate one action from each of n nodes; return new nodes and rewards [m], (n,)."""
