"""Request bodies as Pydantic models, each converted to the dataclass that a service takes."""

from collections.abc import Iterable
from dataclasses import fields, replace
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, WithJsonSchema, model_validator
from pydantic_core import PydanticCustomError

from app.api.descriptions import VALID
from app.api.fields import (
    Body,
    Declared,
    Name,
    Notes,
    RunId,
    SettingsBody,
    Tags,
    given_settings,
    known_members,
    number,
    taken_by,
)
from app.jobs.submissions import BranchStart, LaneStart, RaceStart, TrainingStart
from app.storage.run import ANNOTATIONS
from hexapods.domain.disturbance_documents import AnyDisturbance
from hexapods.domain.errors import InvalidInput
from hexapods.domain.settings import declared_fields
from hexapods.domain.world import MAX_DISTURBANCES, WORLDS, named_world, world_from
from hexapods.runs.clocks import Clock
from hexapods.runs.config import MAX_STEPS, TrainingConfig, WalkingProblem, training_config
from hexapods.runs.lane import LANE_FIELDS
from hexapods.runs.presses import MAX_PRESSES
from hexapods.runs.race_config import Branch
from hexapods.shows.show import MAX_SPEED, MIN_SPEED

WorldName = Annotated[
    str,
    WithJsonSchema({"type": "string", "enum": list(WORLDS)}),
    Field(description=VALID["world"]),
    taken_by(named_world),
]


Disturbances = Annotated[
    list[AnyDisturbance],
    Field(
        max_length=MAX_DISTURBANCES,
        description="Changes of the robot and the ground, by step.",
    ),
]
WALK = {field.name for field in fields(WalkingProblem)} - {"world"}
_PRACTICE = {field.name for field in fields(TrainingConfig)}.difference(
    WALK, ("world", "seed", "agent", "settings")
)


class WalkBody(Body):
    """The walking problem; the fields of `WalkingProblem` are added to it."""

    world: WorldName | None = None
    disturbances: Disturbances = Field(default_factory=list)

    def walk(self) -> WalkingProblem:
        """Convert to the walking problem.

        Raises:
            InvalidInput: if gait, robot or world is not valid.
        """
        world = world_from(self.world, self.disturbances)
        return WalkingProblem(**{name: getattr(self, name) for name in WALK}, world=world)


class PracticeBody(Body):
    """Practice of a training or of a race's lane; fields of `TrainingConfig` are added to it."""

    name: Name | None = None
    seed: Annotated[
        Annotated[int, Declared(declared_fields(TrainingConfig)["seed"])] | None,
        Field(description="0 by default; a lane takes the race's"),
    ] = None
    continue_from: Annotated[RunId | None, Field(description=VALID["continue_from"])] = None
    settings: SettingsBody = Field(default_factory=SettingsBody)

    def practice(self, walk: WalkingProblem, agent: str, seed: int = 0) -> TrainingStart:
        """Convert to the start of an agent's training; `seed` is the default seed.

        Raises:
            InvalidInput: if the values are not valid together.
        """
        if self.continue_from is not None and self.seed is not None:
            raise InvalidInput(
                "a training that continues another goes on with its generator: leave out seed, "
                "or leave out continue_from"
            )
        practice = {name: getattr(self, name) for name in self.model_fields_set & _PRACTICE}
        practice |= given_settings(self.settings)
        chosen_seed = seed if self.seed is None else self.seed
        config = training_config(**vars(walk), **practice, seed=chosen_seed, agent=agent)
        return TrainingStart(config, self.name or None, self.continue_from)


class TrainingBody(PracticeBody, WalkBody):
    """A training. All fields default to the paper's values."""

    agent: str = TrainingConfig.agent

    def start(self) -> TrainingStart:
        """Convert to the request of the service.

        Raises:
            InvalidInput: if the values are not valid together.
        """
        return self.practice(self.walk(), self.agent)


class LaneBody(Body):
    """A lane, with its agent's settings unless they are those of its training.

    Q-learning and its like need `training_id`, `training`, or `keep_learning`. The fields of
    `LaneConfig` are added to it.
    """

    agent: str
    training_id: Annotated[RunId | None, Field(description=VALID["training_id"])] = None
    training: Annotated[PracticeBody | None, Field(description=VALID["training"])] = None
    settings: SettingsBody = Field(default_factory=SettingsBody)

    def start(self, walk: WalkingProblem, seed: int) -> LaneStart:
        """Convert to the request of the service."""
        practice = self.training
        training = None if practice is None else practice.practice(walk, self.agent, seed)
        fields_of_lane = {
            name: getattr(self, name) for name in LANE_FIELDS if getattr(self, name) is not None
        }
        settings = given_settings(self.settings)
        return LaneStart(self.agent, self.training_id, training, fields_of_lane, settings)


class RaceBody(WalkBody):
    """A race, by default of the paper's three lanes; its learners are trained first."""

    name: Name | None = None
    steps: int
    seed: int
    lanes: list[LaneBody]

    def start(self) -> RaceStart:
        """Convert to the request of the service.

        Raises:
            InvalidInput: if the values are not valid together.
        """
        walk = self.walk()
        # Practice comes before: in the world as it is at the start of the race.
        practice = replace(walk, world=walk.world.at_start)
        lanes = [lane.start(practice, self.seed) for lane in self.lanes]
        return RaceStart(walk, lanes, self.steps, self.seed, self.name or None)


class BranchBody(Body):
    """A race that repeats another up to a step; all else that it does not say is from there."""

    name: Name | None = None
    branch_from: Annotated[Branch, known_members(Branch)]
    disturbances: Disturbances = Field(default_factory=list)

    @model_validator(mode="before")
    @classmethod
    def _begin_at_the_branch(cls, value: Any) -> Any:
        """Set the first step of each disturbance to that of the branch by default."""
        match value:
            case {"branch_from": {"step": step}, "disturbances": [*given]}:
                begun = [{"at_step": step, **x} if isinstance(x, dict) else x for x in given]
                return {**value, "disturbances": begun}
        return value

    def start(self) -> BranchStart:
        """Convert to the request of the service."""
        return BranchStart(self.branch_from, self.disturbances, self.name or None)


def one_given(names: Iterable[str]) -> dict[str, Any]:
    """Return the part of a schema that requires at least one of these fields."""
    return {
        "anyOf": [
            {"required": [name], "properties": {name: {"not": {"type": "null"}}}} for name in names
        ]
    }


class PatchBody(Body):
    """Changes, of which at least one is given."""

    @model_validator(mode="after")
    def _require_a_change(self) -> "PatchBody":
        if not self.changes():
            names = ", ".join(type(self).model_fields)
            raise PydanticCustomError("says_all", "{message}", {"message": f"Give one of {names}"})
        return self

    def changes(self) -> dict[str, Any]:
        """Return the given fields."""
        return self.model_dump(exclude_none=True)


PressBody = tuple[
    Annotated[float, number(ge=0, le=MAX_STEPS)], Annotated[float, number(ge=-1, le=1)]
]
"""Steps done in the picture when it was pressed, and its value."""


class ChangeBody(PatchBody):
    """Changes to a running training: its pace, live settings of its agent, and presses.

    `presses` are those of + and - by who watches, for an agent that learns from them: pairs of the
    steps done in the picture then, and a value from -1 to 1.
    """

    model_config = ConfigDict(
        json_schema_extra={
            "anyOf": [
                *one_given(["pace"])["anyOf"],
                {"required": ["settings"], "properties": {"settings": {"minProperties": 1}}},
                *one_given(["presses"])["anyOf"],
            ]
        }
    )

    pace: Annotated[Any, Declared(declared_fields(TrainingConfig)["pace"])] | None = None
    settings: SettingsBody = Field(default_factory=SettingsBody)
    presses: Annotated[list[PressBody], Field(min_length=1, max_length=MAX_PRESSES)] | None = None

    def changes(self) -> dict[str, Any]:
        """Return the given fields."""
        return {name: value for name, value in super().changes().items() if value != {}}


class AnnotationBody(PatchBody):
    """Changes to what users say of a run."""

    model_config = ConfigDict(json_schema_extra=one_given(ANNOTATIONS))

    name: Name | None = None
    tags: Tags | None = None
    notes: Notes | None = None


class StageBody(Body):
    """Changes to the stage; omitted fields are unchanged."""

    run_id: RunId | None = None
    time_s: Annotated[float, number(ge=0)] | None = None
    playing: Annotated[bool, Field(strict=True)] | None = None
    speed: Literal["time-lapse"] | Annotated[float, number(ge=MIN_SPEED, le=MAX_SPEED)] | None = (
        None
    )
    clock: Clock | None = None
    end_at_time_out: (
        Annotated[
            bool,
            Field(
                strict=True,
                description="whether the show of a race ends with its photo finish, or goes on "
                "until the last lane has ended; true again with the next run",
            ),
        ]
        | None
    ) = None
    stay: Annotated[bool, Field(strict=True, description="keep the run that is on the stage")] = (
        False
    )
