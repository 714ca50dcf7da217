"""A stored robot: its document's id, and what people say of it."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any

from hexapods.domain.creatures import CREATURES
from hexapods.domain.gait import AnyGait, gait_as_json
from hexapods.domain.records import Record
from hexapods.domain.robot import Robot, robot
from hexapods.domain.robot_library import About
from hexapods.domain.text import MAX_NAME

MAX_ROBOTS = 500
"""Robots that are stored at most."""


@dataclass(frozen=True, kw_only=True)
class RobotFields(Record):
    """What is stored of a robot beside its document; all but its id may change while that stays.

    Attributes:
        id: beginning of the SHA-256 of its document.
        name: no other robot here has it.
        hidden: whether it is left out where a robot is chosen.
        gait: one that suits it; None for one leg after another.
        guesses: of a robot from a file: what was guessed, in sentences.
        repairs: likewise, what was repaired.
        choices: likewise, what a person has corrected.
        file: name of the file that it is from; None if it was made here.
        created_at: in UTC.
    """

    id: str
    name: str
    hidden: bool = False
    gait: AnyGait | None = None
    guesses: tuple[str, ...] = ()
    repairs: tuple[str, ...] = ()
    choices: Mapping[str, Any] | None = None
    file: str | None = None
    created_at: datetime = field(default_factory=lambda: datetime.now(UTC))


class StoredRobot(RobotFields):
    """A stored robot, whose document this process's library has."""

    @property
    def robot(self) -> Robot:
        """The robot.

        Raises:
            InvalidInput: if its document is not here, or damaged.
        """
        return robot({"id": self.id, "name": self.name})

    @property
    def about(self) -> About:
        """Its name and its gait, for a library."""
        return About(self.name, None if self.gait is None else gait_as_json(self.gait))


def distinct_name(name: str, taken: Collection[str]) -> str:
    """Return a name that is not taken, nor that of a robot which is built in: `Rex`, `Rex 2`."""
    used = {used_name.casefold() for used_name in (*taken, *CREATURES)}
    number, distinct = 1, name[:MAX_NAME]
    while distinct.casefold() in used:
        number += 1
        end = f" {number}"
        distinct = name[: MAX_NAME - len(end)] + end
    return distinct
