"""The part of a card on which a class teaches a robot by presses of + and −."""

from dataclasses import dataclass
from typing import Annotated, Literal

from annotated_types import Ge, Le

from app.jobs.jobs import MAX_CHANGES
from hexapods.domain.errors import InvalidInput
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


def check_steps(teach: Teach, where: str) -> None:
    """Check that presses for each step of the robot can be sent to its training.

    Args:
        teach: the part of a card.
        where: its place in the lesson, for messages.

    Raises:
        InvalidInput: if the robot takes more steps than a run takes changes.
    """
    if teach.steps > MAX_CHANGES:
        raise InvalidInput(
            f"{where}: {teach.seconds:g} seconds with step_s {teach.step_s:g} are {teach.steps:,} "
            f"steps of the robot; valid are at most {MAX_CHANGES:,}, as many as a run takes "
            f"changes: at most {MAX_CHANGES * teach.step_s:g} seconds with this step_s"
        )
