"""The part of a card on which a class teaches a robot by presses of + and −."""

from dataclasses import dataclass
from typing import Annotated, Literal

from annotated_types import Ge, Le

from hexapods.domain.records import Record

Seconds = Annotated[float, Ge(20), Le(900)]
StepSeconds = Annotated[float, Ge(0.4), Le(4)]


@dataclass(frozen=True, kw_only=True)
class Teach(Record):
    """How a class teaches a robot; gait, robot and simulator are those of the card's form.

    Attributes:
        agent: learner of the class's robot, and of the one beside it.
        rival: what the robot beside it learns from: the `reward` itself, or a `simulated` person.
        seconds: how long the class teaches [s].
        step_s: how long a step of the robot lasts, which walks slower for that [s].
    """

    agent: Literal["tamer"] = "tamer"
    rival: Literal["reward", "simulated"] = "reward"
    seconds: Seconds = 120
    step_s: StepSeconds = 1.28

    @property
    def steps(self) -> int:
        """Number of steps of the robot while the class teaches."""
        return max(1, round(self.seconds / self.step_s))
