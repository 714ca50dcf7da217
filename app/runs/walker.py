"""Walker: a simulator, its current state and an agent, as driven by both loops."""

from collections.abc import Sequence
from functools import cached_property
from typing import Any, cast

from app.agents.protocol import Agent, Node, Valuing
from app.domain.errors import IllegalAction
from app.domain.observation import Observation, legal_actions, observe, planned_offsets
from app.domain.simulator import Simulator, Step, WalkState
from app.domain.types import Action, Cells, FloatArray
from app.runs.records import ActionValues


class FutureNode:
    """Node of a search tree: a simulated future state, with lazily computed legal actions."""

    def __init__(self, expand: "SimulatorExpand", state: WalkState) -> None:
        self.state, self._expand = state, expand

    @cached_property
    def legal(self) -> Sequence[Action]:
        """The legal actions in this state, by the walker's observation mode."""
        return self._expand.legal(self.state)


class Readings:
    """The observations of a robot's current state, each read at most once per state."""

    def __init__(self, simulator: Simulator[Any]) -> None:
        self._simulator = simulator
        self.at(simulator.rest())

    def at(self, state: WalkState) -> None:
        """Set the current state of the robot."""
        self._state = state
        self._read: dict[Observation, Cells] = {}

    def __call__(self, how: Observation) -> Cells:
        """Return the cells that an agent observes in the current state, one per pair."""
        if how not in self._read:
            self._read[how] = observe(self._simulator, self._state, how)
        return self._read[how]

    @property
    def planned_offsets_m(self) -> Sequence[tuple[float, float]]:
        """Each pair's offset (x, y) from home by dead reckoning."""
        return planned_offsets(self._state)


class SimulatorExpand:
    """Implements the `Expand` protocol by simulation, and counts simulated transitions.

    Attributes:
        transitions: number of transitions simulated so far.
        here: root node, the current state of the robot.
    """

    def __init__(self, simulator: Simulator[Any], observation: Observation) -> None:
        self._simulator, self._observation = simulator, observation
        self.transitions = 0
        self.here = FutureNode(self, simulator.rest())

    def __call__(
        self, nodes: Sequence[Node], actions: Sequence[Action]
    ) -> tuple[Sequence[Node], FloatArray]:
        """Simulate one action from each node, in one batch.

        Args:
            nodes: n nodes.
            actions: one action for each.

        Returns:
            the resulting nodes, and the rewards [m], (n,).
        """
        states = [cast(FutureNode, node).state for node in nodes]
        expansion = self._simulator.expand(states, actions)
        self.transitions += len(actions)
        return [FutureNode(self, state) for state in expansion.states], expansion.rewards_m

    def at(self, state: WalkState) -> None:
        """Set the current state of the robot, the root of the search."""
        self.here = FutureNode(self, state)

    def legal(self, state: WalkState) -> Sequence[Action]:
        """Return the legal actions in a state."""
        observed = observe(self._simulator, state, self._observation)
        return legal_actions(observed, len(self._simulator.grid))


class Walker:
    """A simulated robot, its current state, and the agent that controls it.

    Attributes:
        simulator: simulates steps.
        agent: chooses actions.
        observation: observation mode.
        state: current state of the simulation.
        observed: current observation, the cell of each leg pair.
        legal: legal actions in the current state.
    """

    def __init__(
        self,
        simulator: Simulator[Any],
        agent: Agent,
        observation: Observation,
        expand: SimulatorExpand | None = None,
        readings: Readings | None = None,
    ) -> None:
        self.simulator, self.agent, self.observation = simulator, agent, observation
        self._expand, self._readings = expand, readings or Readings(simulator)
        self.place(simulator.rest())

    def place(self, state: WalkState) -> None:
        """Set the current state, and update the observation and the legal actions."""
        self.state = state
        self._readings.at(state)
        self.observed: Cells = self._readings(self.observation)
        self.legal = legal_actions(self.observed, len(self.simulator.grid))
        if self._expand:
            self._expand.at(state)

    @property
    def transitions(self) -> int:
        """Number of transitions that the agent has simulated so far."""
        return self._expand.transitions if self._expand else 0

    def decide(self) -> Action:
        """Return the action that the agent chooses in the current state.

        Raises:
            IllegalAction: if it is not legal.
        """
        return self.legal_action(self.agent.act(self.observed, self.legal))

    def legal_action(self, chosen: Sequence[int]) -> Action:
        """Return an action given as (pair, cell) after checking that it is legal.

        Raises:
            IllegalAction: if it is not legal in the current state.
        """
        try:
            return self.legal[self.legal.index(Action(*chosen))]
        except (TypeError, ValueError) as error:
            raise IllegalAction(
                f"{type(self.agent).__name__} chose {chosen!r}, which is not a legal action here; "
                "choose one of the (pair, cell) in legal"
            ) from error

    def carry_out(self, action: Action, record: bool = False) -> Step[Any]:
        """Simulate an action, and make the resulting state the current one."""
        step = self.simulator.step(self.state, action, record)
        self.place(step.state)
        return step

    def knowledge(self) -> ActionValues | None:
        """Return the action values of the current state; None if the agent has none."""
        if not isinstance(self.agent, Valuing):
            return None
        return ActionValues(self.agent.values(self.observed), self.agent.visits(self.observed))
