"""An agent that lets someone have a word before each of its decisions."""

from collections.abc import Callable, Sequence

from app.agents.protocol import Agent, AgentState, Transition
from app.domain.types import Action, Cells


class ListeningAgent:
    """Implements `Agent` by another one, and calls `listen` before it acts."""

    def __init__(self, agent: Agent, listen: Callable[[], None]) -> None:
        self._agent, self._listen = agent, listen

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        """Listen, then act."""
        self._listen()
        return self._agent.act(observation, legal)

    def learn(self, transition: Transition) -> None:
        """As the other does."""
        self._agent.learn(transition)

    def state(self) -> AgentState:
        """Of the other."""
        return self._agent.state()

    def load(self, state: AgentState) -> None:
        """Into the other."""
        self._agent.load(state)
