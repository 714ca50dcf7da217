"""Walker: a simulator, its current state and an agent, as driven by both loops."""

from collections.abc import Sequence
from functools import cached_property
from typing import Any, cast

import numpy as np

from app.agents.protocol import Agent, Node, Transition, Valuing
from app.domain.errors import IllegalAction
from app.domain.observation import Observation, legal_actions, observe
from app.domain.simulator import Simulator, Step, WalkState
from app.domain.types import Action, Cells, FloatArray
from app.runs.records import ActionValues

_MAX_BATCH = 2048
"""Transitions simulated at once: the servo targets of one take some 10 kB."""


class FutureNode:
    """Node of a search tree: a simulated future state, with lazily computed properties."""

    def __init__(self, expand: "SimulatorExpand", state: WalkState) -> None:
        self.state, self._expand = state, expand

    @cached_property
    def legal(self) -> Sequence[Action]:
        """The legal actions in this state, by the walker's observation mode."""
        return self._expand.legal(self.state)

    @cached_property
    def offsets_m(self) -> Sequence[tuple[float, float]]:
        """Measured offset (x, y) of each pair's leader from home [m]."""
        return self._expand.offsets_m(self.state)


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
        ends: list[FutureNode] = []
        rewards: list[FloatArray] = []
        for first in range(0, len(states), _MAX_BATCH):
            part = slice(first, first + _MAX_BATCH)
            expansion = self._simulator.expand(states[part], actions[part])
            ends += [FutureNode(self, state) for state in expansion.states]
            rewards.append(expansion.rewards_m)
        self.transitions += len(actions)
        return ends, np.concatenate(rewards) if rewards else np.empty(0)

    def at(self, state: WalkState) -> None:
        """Set the current state of the robot, the root of the search."""
        self.here = FutureNode(self, state)

    def offsets_m(self, state: WalkState) -> Sequence[tuple[float, float]]:
        """Return where the feet are measured in a state, per pair [m]."""
        return self._simulator.pair_offsets(state)

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
        keeps_learning: whether the agent learns in a race.
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
    ) -> None:
        self.simulator, self.agent, self.observation = simulator, agent, observation
        self.keeps_learning = False
        self._expand = expand
        self.place(simulator.rest())

    def place(self, state: WalkState) -> None:
        """Set the current state, and update the observation and the legal actions."""
        self.state = state
        self.observed: Cells = observe(self.simulator, state, self.observation)
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

    def knowledge(self) -> ActionValues | None:
        """Return the action values of the current state; None if the agent has none."""
        if not isinstance(self.agent, Valuing):
            return None
        return ActionValues(self.agent.values(self.observed), self.agent.visits(self.observed))
