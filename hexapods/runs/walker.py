"""Walker: a simulator, its current state and an agent, as driven by both loops."""

import math
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any, cast

import numpy as np

from hexapods.agents.protocol import Agent, Node, Transition, Valuing
from hexapods.domain.disturbances import SensorNoise
from hexapods.domain.errors import BudgetExceeded, IllegalAction
from hexapods.domain.observation import (
    Observation,
    legal_in,
    measured_offsets,
    observe,
)
from hexapods.domain.posture import heading_deg
from hexapods.domain.simulator import Simulator, Step, WalkState
from hexapods.domain.types import Action, Cells, FloatArray
from hexapods.runs.records import ActionValues

_MAX_BATCH = 1024
"""Transitions simulated at once: the servo targets of one take some 10 kB, and no interruption is
heeded meanwhile, for half a second or so in MuJoCo."""


class SearchInterrupted(BaseException):
    """Raised to abandon a decision; no `Exception`, so that no agent takes it for a failure."""


class FutureNode:
    """Node of a search tree: a simulated future state, with lazily computed properties."""

    def __init__(
        self,
        expand: "SimulatorExpand",
        state: WalkState,
        observed: "Sensors | None" = None,
        legal: Sequence[Action] = (),
    ) -> None:
        """Create a node.

        Args:
            expand: simulator that expands the node.
            state: state of the node.
            observed: sensors of the robot, for the root node.
            legal: legal actions, for the root node.
        """
        self.state, self._expand = state, expand
        if observed is not None:
            self.legal, self.offsets_m = legal, observed.offsets_m

    @cached_property
    def legal(self) -> Sequence[Action]:
        """The legal actions in this state, by the walker's observation mode."""
        return self._expand.legal(self.state)

    @cached_property
    def offsets_m(self) -> Sequence[tuple[float, float]]:
        """Measured offset (x, y) of each group from home [m]."""
        return self._expand.offsets_m(self.state)


class Sensors:
    """The robot's sensors: observations of its current state, each read at most once per state.

    Attributes:
        error_m: errors of the measured offsets in this state, the same for all that is read from
            it, (groups, 2) [m]; None where sensors are exact.
    """

    def __init__(
        self,
        simulator: Simulator[Any],
        noise: Callable[[int], np.random.Generator] | None = None,
    ) -> None:
        """Create the sensors of a robot at rest.

        Args:
            simulator: simulates the robot.
            noise: makes the generator of the errors of measurement after so many steps, where
                sensors are noisy; None for no errors.
        """
        self._simulator, self._noise = simulator, noise
        self.at(simulator.rest())

    def at(self, state: WalkState) -> None:
        """Set the current state of the robot."""
        self._state = state
        self._read: dict[Observation, Cells] = {}
        self.error_m = self._error()

    def _error(self) -> FloatArray | None:
        steps = self._state.steps
        noise = self._simulator.world.as_of(steps).one_of(SensorNoise)
        if noise is None or self._noise is None:
            return None
        return self._noise(steps).normal(0, noise.sd_m, (len(self._simulator.gait.groups), 2))

    @property
    def offsets_m(self) -> Sequence[tuple[float, float]]:
        """Measured offset (x, y) of each group from home, with errors [m]."""
        return measured_offsets(self._simulator, self._state, self.error_m)

    def __call__(self, how: Observation) -> Cells:
        """Return the cells that an agent observes in the current state, one per group."""
        if how not in self._read:
            self._read[how] = observe(self._simulator, self._state, how, self.error_m)
        return self._read[how]

    @property
    def planned_offsets_m(self) -> Sequence[tuple[float, float]]:
        """Each group's offset (x, y) from home by dead reckoning."""
        return self._state.feet.offsets_m

    @property
    def heading_rad(self) -> float:
        """Angle by which the torso has turned since the start, anticlockwise, without errors."""
        start, torso = self._simulator.torso(self._simulator.rest()), self._simulator.torso
        return math.radians(heading_deg(torso(self._state), start))


class SimulatorExpand:
    """Implements the `Expand` protocol by simulation, and counts simulated transitions.

    A search begins in the state that the robot's sensors measure: where they are noisy, the root
    has the measured offsets of the feet. All of a search is simulated under the conditions of the
    step that is about to be taken: later disturbances are not foreseen.

    Attributes:
        transitions: number of transitions simulated so far.
        budget: most transitions that may be simulated; None for any number.
        here: root node, the current state of the robot.
        interrupt: function called before each batch; may raise `SearchInterrupted`.
    """

    def __init__(self, simulator: Simulator[Any], observation: Observation) -> None:
        self._simulator, self._observation = simulator, observation
        self.transitions = 0
        self.budget: int | None = None
        self.interrupt: Callable[[], None] = lambda: None
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

        Raises:
            BudgetExceeded: if the batch would exceed the budget of transitions.
        """
        if self.budget is not None and self.transitions + len(actions) > self.budget:
            raise BudgetExceeded(
                f"it would have simulated over {self.budget:,} transitions, which is the most"
            )
        states = [cast(FutureNode, node).state for node in nodes]
        ends: list[FutureNode] = []
        rewards: list[FloatArray] = []
        for first in range(0, len(states), _MAX_BATCH):
            self.interrupt()
            batch = slice(first, first + _MAX_BATCH)
            expansion = self._simulator.expand(
                states[batch], actions[batch], as_of=self.here.state.steps
            )
            ends += [FutureNode(self, state) for state in expansion.states]
            rewards.append(expansion.rewards_m)
        self.transitions += len(actions)
        return ends, np.concatenate(rewards) if rewards else np.empty(0)

    def at(self, state: WalkState, observed: Sensors, legal: Sequence[Action]) -> None:
        """Set the current state of the robot, of which the root of the search is an estimate.

        Args:
            state: the true state.
            observed: sensors of the robot.
            legal: the legal actions.
        """
        if observed.error_m is not None:
            state = self._simulator.estimate(state, observed.error_m)
        self.here = FutureNode(self, state, observed, legal)

    def offsets_m(self, state: WalkState) -> Sequence[tuple[float, float]]:
        """Return the measured offset (x, y) of each group from home in a state [m]."""
        return self._simulator.group_offsets(state)

    def legal(self, state: WalkState) -> Sequence[Action]:
        """Return the legal actions in a state."""
        observed = observe(self._simulator, state, self._observation)
        return legal_in(self._simulator, state, observed)


class Walker:
    """A simulated robot, its current state, and the agent that controls it.

    Attributes:
        simulator: simulates steps.
        agent: chooses actions.
        observation: observation mode.
        keeps_learning: whether the agent learns in a race.
        expand: simulates what the agent's search asks for; None for an agent that does not search.
        state: current state of the simulation.
        observed: current observation, the cell of each group of legs.
        legal: legal actions in the current state.
    """

    def __init__(
        self,
        simulator: Simulator[Any],
        agent: Agent,
        observation: Observation,
        expand: SimulatorExpand | None = None,
        sensors: Sensors | None = None,
    ) -> None:
        self.simulator, self.agent, self.observation = simulator, agent, observation
        self.keeps_learning = False
        self.expand, self._sensors = expand, sensors or Sensors(simulator)
        self.set_state(simulator.rest())

    def set_state(self, state: WalkState) -> None:
        """Set the current state, and update the observation and the legal actions."""
        self.state = state
        self._sensors.at(state)
        self.observed: Cells = self._sensors(self.observation)
        self.legal = legal_in(self.simulator, state, self.observed)
        if self.expand:
            self.expand.at(state, self._sensors, self.legal)

    @property
    def measured(self) -> Cells:
        """The measured cells in the current state, whatever the observation mode is."""
        return self._sensors("measured")

    @property
    def transitions(self) -> int:
        """Number of transitions that the agent has simulated so far."""
        return self.expand.transitions if self.expand else 0

    def interrupt_by(self, interrupt: Callable[[], None]) -> None:
        """Let a function interrupt the agent's search, by raising `SearchInterrupted`."""
        if self.expand:
            self.expand.interrupt = interrupt

    def decide(self) -> Action:
        """Return the action that the agent chooses in the current state.

        Raises:
            IllegalAction: if it is not legal.
        """
        return self.legal_action(self.agent.act(self.observed, self.legal))

    def legal_action(self, chosen: Sequence[int]) -> Action:
        """Return an action given as (group, cell) after checking that it is legal.

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

    def carry_out(self, action: Action, record: bool = False, effort: bool = False) -> Step[Any]:
        """Simulate an action as `Simulator.step`; its result becomes the current state."""
        step = self.simulator.step(self.state, action, record, effort)
        self.set_state(step.state)
        return step

    def learn(self, observation: Cells, action: Action, reward_m: float) -> Action | None:
        """Let the agent learn from the step that was just carried out.

        Args:
            observation: observation before the step.
            action: the step's action.
            reward_m: its reward [m].

        Returns:
            the action that an on-policy agent has chosen to take next; None for other agents.

        Raises:
            IllegalAction: if that action is not legal.
        """
        next_action = self.decide() if getattr(self.agent, "is_on_policy", False) else None
        self.agent.learn(
            Transition(observation, action, reward_m, self.observed, self.legal, next_action)
        )
        return next_action

    def action_values(self) -> ActionValues | None:
        """Return the action values of the current state; None if the agent has none."""
        if not isinstance(self.agent, Valuing):
            return None
        return ActionValues(self.agent.values(self.observed), self.agent.visits(self.observed))
