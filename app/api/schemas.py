"""Request bodies as Pydantic models, each converted to the dataclass that a service takes."""

from collections.abc import Iterable
from dataclasses import replace
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Discriminator, Field, Tag, WithJsonSchema, model_validator
from pydantic_core import PydanticCustomError

from app.api.descriptions import VALID
from app.api.disturbance_body import Disturbances, Leg
from app.api.fields import (
    INTEGRAL,
    Body,
    Divisions,
    EvaluateEvery,
    GridSide,
    KeepLearning,
    LaneObservation,
    Name,
    Notes,
    Pace,
    PlansWith,
    RaceSteps,
    RobotBody,
    RunId,
    Seed,
    SettingsBody,
    Steps,
    StepsPerEpisode,
    Tags,
    Tolerance,
    given_settings,
    number,
)
from app.jobs.submissions import BranchStart, LaneStart, RaceStart, TrainingStart
from app.storage.run import ANNOTATIONS
from hexapods.domain.errors import InvalidInput
from hexapods.domain.gait import NAMED_GAITS, GaitSpec, Symmetry
from hexapods.domain.observation import Observation
from hexapods.domain.robot import robot
from hexapods.domain.world import WORLDS, world_from
from hexapods.runs.clocks import Clock
from hexapods.runs.config import (
    RACE_STEPS,
    SimulatorName,
    TrainingConfig,
    WalkingProblem,
    training_config,
)
from hexapods.runs.race_config import MAX_RACE_STEPS, Branch
from hexapods.shows.show import MAX_SPEED, MIN_SPEED

WorldName = Annotated[
    str,
    WithJsonSchema({"type": "string", "enum": list(WORLDS)}),
    Field(description=VALID["world"]),
]


class GaitBody(Body):
    """A custom gait."""

    model_config = ConfigDict(
        json_schema_extra={
            "oneOf": [
                {"required": ["symmetry"], "properties": {"symmetry": {"type": "string"}}},
                {"required": ["pairs"], "properties": {"pairs": {"type": "array"}}},
            ]
        }
    )

    right_leg: Leg
    left_leg: Leg
    symmetry: Symmetry | None = None
    pairs: list[tuple[Leg, Leg]] | None = None

    def spec(self) -> GaitSpec:
        """Convert to the specification of the domain."""
        pairs = None if self.pairs is None else tuple(self.pairs)
        return GaitSpec(self.right_leg, self.left_leg, self.symmetry, pairs)


def _gait_tag(value: Any) -> str:
    return "its name" if isinstance(value, str) else "its parts"


Gait = Annotated[
    Annotated[str, Tag("its name"), WithJsonSchema({"type": "string", "enum": list(NAMED_GAITS)})]
    | Annotated[GaitBody, Tag("its parts")],
    Discriminator(_gait_tag),
    Field(description=VALID["gait"]),
]


class WalkBody(Body):
    """The walking problem: gait, robot, simulator and foot grid."""

    gait: Gait
    robot: RobotBody = "stiff"
    simulator: SimulatorName = WalkingProblem.simulator
    divisions: Divisions = WalkingProblem.divisions
    grid_side_m: GridSide = WalkingProblem.grid_side_m
    tolerance: Tolerance = WalkingProblem.tolerance
    world: WorldName | None = None
    disturbances: Annotated[Disturbances, Field(default_factory=list)]

    def walk(self) -> WalkingProblem:
        """Convert to the walking problem.

        Raises:
            InvalidInput: if gait, robot or world is not valid.
        """
        return WalkingProblem(
            gait=self.gait.spec() if isinstance(self.gait, GaitBody) else self.gait,
            robot=robot(self.robot),
            simulator=self.simulator,
            divisions=self.divisions,
            grid_side_m=self.grid_side_m,
            tolerance=self.tolerance,
            world=world_from(self.world, (body.disturbance() for body in self.disturbances)),
        )


class PracticeBody(Body):
    """Practice parameters of a training or of a race's lane."""

    name: Name | None = None
    steps: Steps = TrainingConfig.steps
    seed: Annotated[Seed | None, Field(description="0 by default; a lane takes the race's")] = None
    observation: Observation = TrainingConfig.observation
    steps_per_episode: StepsPerEpisode = TrainingConfig.steps_per_episode
    evaluate_every: EvaluateEvery = TrainingConfig.evaluate_every
    pace: Pace = TrainingConfig.pace
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
        other_fields = {"name", "seed", "continue_from", "agent", *WalkBody.model_fields}
        own = self.model_fields_set - other_fields - {"settings"}
        given = {name: getattr(self, name) for name in own} | given_settings(self.settings)
        chosen_seed = seed if self.seed is None else self.seed
        config = training_config(**vars(walk), **given, seed=chosen_seed, agent=agent)
        return TrainingStart(config, self.name or None, self.continue_from)


class TrainingBody(PracticeBody, WalkBody):
    """A training. All fields but the gait default to the paper's values."""

    agent: str = TrainingConfig.agent

    def start(self) -> TrainingStart:
        """Convert to the request of the service.

        Raises:
            InvalidInput: if the values are not valid together.
        """
        return self.practice(self.walk(), self.agent)


class LaneBody(Body):
    """A lane, with its agent's settings unless they are those of its training.

    Q-learning and its like need `training_id`, `training`, or `keep_learning`.
    """

    agent: str
    training_id: Annotated[RunId | None, Field(description=VALID["training_id"])] = None
    training: Annotated[PracticeBody | None, Field(description=VALID["training"])] = None
    keep_learning: KeepLearning | None = None
    plans_with: PlansWith | None = None
    observation: LaneObservation | None = None
    settings: SettingsBody = Field(default_factory=SettingsBody)

    def start(self, walk: WalkingProblem, seed: int) -> LaneStart:
        """Convert to the request of the service."""
        practice = self.training
        training = None if practice is None else practice.practice(walk, self.agent, seed)
        return LaneStart(
            self.agent,
            self.training_id,
            training,
            self.keep_learning,
            self.plans_with,
            given_settings(self.settings),
            self.observation,
        )


class RaceBody(WalkBody):
    """A race, by default of the paper's three lanes; its learners are trained first."""

    name: Name | None = None
    steps: RaceSteps = RACE_STEPS
    seed: Seed = 0
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


class BranchFrom(Body):
    """A moment of a race."""

    race_id: RunId
    # The domain checks the number of steps that the race has taken.
    step: Annotated[
        int,
        Field(strict=True, ge=0, lt=MAX_RACE_STEPS, description=VALID["branch_from.step"]),
        INTEGRAL,
    ]

    def branch(self) -> Branch:
        """Convert to the value of the domain."""
        return Branch(self.race_id, self.step)


class BranchBody(Body):
    """A race that repeats another up to a step; all else that it does not say is from there."""

    name: Name | None = None
    branch_from: BranchFrom
    disturbances: Annotated[Disturbances, Field(default_factory=list)]

    def start(self) -> BranchStart:
        """Convert to the request of the service: what happens, happens at the branch by default.

        Raises:
            InvalidInput: if a disturbance is not valid.
        """
        branch = self.branch_from.branch()
        disturbances = [
            body.disturbance()
            if "at_step" in body.model_fields_set
            else body.model_copy(update={"at_step": branch.step}).disturbance()
            for body in self.disturbances
        ]
        return BranchStart(branch, disturbances, self.name or None)


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


class ChangeBody(PatchBody):
    """Changes to a running training: its pace, and live settings of its agent."""

    model_config = ConfigDict(
        json_schema_extra={
            "anyOf": [
                *one_given(["pace"])["anyOf"],
                {"required": ["settings"], "properties": {"settings": {"minProperties": 1}}},
            ]
        }
    )

    pace: Pace | None = None
    settings: SettingsBody = Field(default_factory=SettingsBody)

    def changes(self) -> dict[str, Any]:
        """Return the given fields."""
        return {name: value for name, value in super().changes().items() if value != {}}


class AnnotationBody(PatchBody):
    """Changes to what users say of a run."""

    model_config = ConfigDict(json_schema_extra=one_given(ANNOTATIONS))

    name: Name | None = None
    tags: Tags | None = None
    notes: Notes | None = None


class TrialBody(Body):
    """A trial of an experiment."""

    key: Annotated[str, Field(min_length=1, max_length=1000, description=VALID["key"])]


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
    stay: Annotated[bool, Field(strict=True, description="keep the run that is on stage")] = False
