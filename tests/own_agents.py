"""Agents as a user might write them, good and bad; found as `tests.own_agents:Name`."""

import os
import time
from collections.abc import Sequence
from typing import Annotated, Any, Literal

import numpy as np

from hexapods.agents.linear_model import LinearModel
from hexapods.agents.lookahead import LookAhead
from hexapods.agents.protocol import AgentState, Expand, Observe, Problem, Transition
from hexapods.agents.q_learning import QLearning
from hexapods.domain.observation import OBSERVATIONS
from hexapods.domain.settings import Setting
from hexapods.domain.types import Action, Cells

Mood = Annotated[Literal["dull", "bright"], Setting(title="Mood", help="Whether it thinks.")]


class Restless:
    """Goes anywhere; remembers how much it earned."""

    def __init__(self, rng: np.random.Generator, problem: Problem) -> None:
        self._rng, self.problem, self.earned_m = rng, problem, 0.0

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        return legal[int(self._rng.integers(len(legal)))]

    def learn(self, transition: Transition) -> None:
        self.earned_m += transition.reward_m

    def state(self) -> AgentState:
        return {"earned_m": np.array([self.earned_m])}

    def load(self, state: AgentState) -> None:
        self.earned_m = float(state["earned_m"][0])


class ThreeStep(LookAhead):
    """Looks one step further than ours."""

    def __init__(self, expand: Expand) -> None:
        super().__init__(expand, depth=3)


class Undecided(LookAhead):
    """Simulates for as long as it is let."""

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        while True:
            self._expand([self._expand.here], legal[:1])


class Ponderous(Restless):
    """Thinks for longer than anyone waits."""

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        time.sleep(600)
        return super().act(observation, legal)


class Slow(Restless):
    """Takes seconds for an evaluation."""

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        time.sleep(0.2)
        return super().act(observation, legal)


class Parent(Restless):
    """Leaves a process behind that has all its files open."""

    def __init__(self, rng: np.random.Generator, problem: Problem) -> None:
        super().__init__(rng, problem)
        if os.fork() == 0:
            time.sleep(600)
            os._exit(0)


class Moody(LinearModel):
    """Walks well, unless it is dull, which it is by default: then it takes what comes first."""

    def __init__(self, *args: Any, mood: Mood = "dull", **settings: Any) -> None:
        super().__init__(*args, **settings)
        self._mood = mood

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        thought = super().act(observation, legal)
        return thought if self._mood == "bright" else legal[0]


class Plain(Restless):
    """Writes its action as a plain tuple of NumPy numbers, which is as good."""

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        pair, cell = super().act(observation, legal)
        return (np.int64(pair), np.int64(cell))  # type: ignore[return-value]


class Attentive(Restless):
    """Reads its state in every way, before and after each step."""

    def __init__(self, rng: np.random.Generator, problem: Problem, observe: Observe) -> None:
        super().__init__(rng, problem)
        self._observe = observe
        self.read: list[dict[str, Cells]] = []

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        self.read.append({how: self._observe(how) for how in OBSERVATIONS})
        return super().act(observation, legal)

    def learn(self, transition: Transition) -> None:
        self.read.append({how: self._observe(how) for how in OBSERVATIONS})


class Needy(Restless):
    """Asks for what nobody offers."""

    def __init__(self, rng: np.random.Generator, problem: Problem, crystal_ball: object) -> None:
        super().__init__(rng, problem)


class Cheat(Restless):
    """Leaves a pair where it is, which is no action."""

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        return Action(0, observation[0])


class Clumsy(Restless):
    """Breaks on its third step."""

    acted = 0

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        self.acted += 1
        if self.acted == 3:
            raise RuntimeError("I tripped")
        return legal[0]


class Stumbling(QLearning):
    """Learns, but breaks on its third step."""

    acted = 0

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        self.acted += 1
        if self.acted == 3:
            raise RuntimeError("I tripped")
        return super().act(observation, legal)


class Forgetful:
    """Lacks what lets an agent be saved."""

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        return legal[0]

    def learn(self, transition: Transition) -> None:
        pass


class TiresLate(Restless):
    """Breaks when it has learned from fifty steps."""

    learned = 0

    def learn(self, transition: Transition) -> None:
        self.learned += 1
        if self.learned > 50:
            raise RuntimeError("I am tired")
        super().learn(transition)
