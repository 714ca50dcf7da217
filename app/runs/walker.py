"""A robot with an agent on it: sees, decides, acts. Both loops drive walkers."""

from collections.abc import Sequence
from functools import cached_property
from typing import Any, cast

from app.agents.protocol import Agent, Node, Valuing
from app.domain.errors import IllegalAction
from app.domain.observation import Observation, legal_actions, observe
from app.domain.simulator import Simulator, Step, WalkState
from app.domain.types import Action, Cells, FloatArray
from app.runs.records import ActionValues


class FutureNode:
    """A simulated future; what is legal there is found only when asked for."""

    def __init__(self, foresight: "SimulatorExpand", state: WalkState) -> None:
        self.state, self._foresight = state, foresight

    @cached_property
    def legal(self) -> Sequence[Action]:
        """The actions that are legal in this future, by this walker's observation."""
        return self._foresight.legal(self.state)


class SimulatorExpand:
    """Implements `Expand` for one walker: its simulator, its way to observe, and a count."""

    def __init__(self, simulator: Simulator[Any], observation: Observation) -> None:
        self._simulator, self._observation = simulator, observation
        self.transitions = 0
        self.here = FutureNode(self, simulator.rest())

    def __call__(
        self, nodes: Sequence[Node], actions: Sequence[Action]
    ) -> tuple[Sequence[Node], FloatArray]:
        """Simulate one action from each node."""
        states = [cast(FutureNode, node).state for node in nodes]
        expansion = self._simulator.expand(states, actions)
        self.transitions += len(actions)
        return [FutureNode(self, state) for state in expansion.states], expansion.rewards_m

    def at(self, state: WalkState) -> None:
        """The robot is here now."""
        self.here = FutureNode(self, state)

    def legal(self, state: WalkState) -> Sequence[Action]:
        """Return the legal actions in a state."""
        seen = observe(self._simulator, state, self._observation)
        return legal_actions(seen, len(self._simulator.grid))


class Walker:
    """One robot, where it is, and the agent that walks it."""

    def __init__(
        self,
        simulator: Simulator[Any],
        agent: Agent,
        observation: Observation,
        foresight: SimulatorExpand | None = None,
    ) -> None:
        self.simulator, self.agent, self.observation = simulator, agent, observation
        self._foresight = foresight
        self.place(simulator.rest())

    def place(self, state: WalkState) -> None:
        """Put the robot into a state."""
        self.state = state
        self.seen: Cells = observe(self.simulator, state, self.observation)
        self.legal = legal_actions(self.seen, len(self.simulator.grid))
        if self._foresight:
            self._foresight.at(state)

    @property
    def transitions(self) -> int:
        """How many transitions the agent has simulated so far."""
        return self._foresight.transitions if self._foresight else 0

    def decide(self) -> Action:
        """Ask the agent what to do now.

        Raises:
            IllegalAction: if that is none of the legal actions.
        """
        return self.legal_action(self.agent.act(self.seen, self.legal))

    def legal_action(self, chosen: Sequence[int]) -> Action:
        """Find an action among the legal ones.

        Raises:
            IllegalAction: if it is none of them.
        """
        try:
            return self.legal[self.legal.index(Action(*chosen))]
        except (TypeError, ValueError) as error:
            raise IllegalAction(
                f"{type(self.agent).__name__} chose {chosen!r}, which is not a legal action here; "
                "choose one of the (pair, cell) in legal"
            ) from error

    def carry_out(self, action: Action, record: bool = False) -> Step[Any]:
        """Do it, and be where it leads."""
        step = self.simulator.step(self.state, action, record)
        self.place(step.state)
        return step

    def knowledge(self) -> ActionValues | None:
        """Return the action values of the current state; None for agents without."""
        if not isinstance(self.agent, Valuing):
            return None
        return ActionValues(self.agent.values(self.seen), self.agent.visits(self.seen))
