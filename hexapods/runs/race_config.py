"""Configs of races: complete, validated and immutable."""

from dataclasses import dataclass
from typing import Annotated, Any

from annotated_types import Ge, Le, Lt

from hexapods.domain.checks import check_whole
from hexapods.domain.errors import InvalidInput
from hexapods.domain.records import Record
from hexapods.domain.settings import Setting, declared_fields
from hexapods.domain.short_repr import short_repr
from hexapods.domain.text import counted
from hexapods.runs.config import RACE_STEPS, Seed, WalkingProblem
from hexapods.runs.lane import LaneConfig

MAX_LANES = 6
MAX_ID = 64
"""Maximum length of a run's id."""
MAX_RACE_STEPS = 20_000
"""Maximum of steps, summed over a race's lanes: each is recorded, in about 6 kB of memory."""

RaceSteps = Annotated[
    int,
    Ge(1),
    Le(MAX_RACE_STEPS),
    Setting(title="Steps of the race", help="How many steps each robot has in the race."),
]

BRANCH_STEPS = (
    "a whole number from 0 to the steps that the race has taken; at least one must be left"
)
"""The valid steps of a branch, in words."""


@dataclass(frozen=True)
class Branch(Record):
    """The moment of another race at which a race branches off; until then both are the same.

    Attributes:
        race_id: id of the other race.
        step: number of steps that they share.
    """

    race_id: str
    step: Annotated[
        int,
        Ge(0),
        Lt(MAX_RACE_STEPS),
        Setting(title="Step", help="How many steps of that race are repeated."),
    ]

    def __post_init__(self) -> None:
        try:
            step = declared_fields(Branch)["step"].normalized(self.step)
        except InvalidInput:
            shown = repr(self.step)[:80]
            raise InvalidInput(
                f"there is no such step: branch_from.step must be {BRANCH_STEPS}, not {shown}"
            ) from None
        object.__setattr__(self, "step", step)


@dataclass(frozen=True, kw_only=True)
class RaceConfig(WalkingProblem):
    """Config of a race of one to six lanes, 50 steps each by default.

    Attributes:
        lanes: in order.
        steps: of each lane.
        seed: seed of all random generators of the run.
        branch_from: the race whose first steps this one repeats, if any.

    Raises:
        InvalidInput: if there are no or too many lanes, or too many steps in all.
    """

    __repr__ = short_repr

    lanes: tuple[LaneConfig, ...]
    steps: RaceSteps = RACE_STEPS
    seed: Seed = 0
    branch_from: Branch | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.branch_from is not None:
            race_id: Any = self.branch_from.race_id  # it may be from a file
            step = self.branch_from.step
            if not isinstance(race_id, str) or not race_id.isalnum() or len(race_id) > MAX_ID:
                raise InvalidInput(f"branch_from.race_id must be the id of a race, not {race_id!r}")
            check_whole("branch_from.step", step, 0, self.steps - 1)
        if not 1 <= len(self.lanes) <= MAX_LANES:
            raise InvalidInput(f"a race has 1 to {MAX_LANES} lanes, not {len(self.lanes)}")
        if self.steps * len(self.lanes) > MAX_RACE_STEPS:
            raise InvalidInput(
                f"a race records every step in memory, so steps times lanes must be at most "
                f"{MAX_RACE_STEPS:,}, not {self.steps * len(self.lanes):,}: with "
                f"{counted(len(self.lanes), 'lane')} give at most "
                f"{MAX_RACE_STEPS // len(self.lanes):,} steps"
            )
