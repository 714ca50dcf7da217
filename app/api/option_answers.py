"""Response models of `/options`, as those of `app.api.answers`."""

from pydantic import BaseModel, ConfigDict

from app.answer import Answer, Count
from app.events.run_view import Settings
from hexapods.domain.disturbance_documents import AnyDisturbance
from hexapods.domain.gait import AnyGait
from hexapods.domain.robot import AnyRobot
from hexapods.domain.settings import Value
from hexapods.runs.config import SimulatorName


class Described(Answer):
    """An option of a form, with its name on the page and a one-sentence description."""

    name: str
    title: str
    description: str


class GaitOption(Described):
    """A gait, with the directions of the hexapod's legs [°] and the groups that move together."""

    forward_deg: float
    azimuths_deg: list[float]
    pairs: list[list[int]]


class RobotOption(Described):
    """A robot: built in, or stored, which has its id as its name too.

    Attributes:
        id: of a stored robot; null for one that is built in.
        hidden: whether it is left out where a robot is chosen.
        body: of a stored robot: by value, for links that are opened where it is not stored; null
            for one that is built in or from a file.
        grid_side_m: side of a foot grid that suits its size.
        joints: names of the joints of each leg, from the torso to the foot.
        limits_rad: lowest and highest angle of each of them.
        azimuths_deg: directions of its legs in its own frame, anticlockwise.
        gait: a gait that suits it.
        gaits: names of the gaits that its legs can have.
        recommended_agent: by each of these gaits the learner to begin with, on the usual foot grid;
            `POST /robots/preview` says why, and of any gait and grid.
        built: parts in whose place a disturbance puts another value, as they were built.
    """

    id: str | None
    hidden: bool
    body: AnyRobot | None
    robot: AnyRobot
    grid_side_m: float
    joints: list[list[str]]
    limits_rad: list[list[tuple[float, float]]]
    azimuths_deg: list[float]
    gait: AnyGait
    gaits: list[str]
    recommended_agent: dict[str, str]
    built: dict[str, float]


class TrainingDefaults(BaseModel):
    """Default request body of a training."""

    model_config = ConfigDict(extra="allow")

    agent: str
    robot: str
    simulator: SimulatorName
    settings: Settings


class LaneDefaults(BaseModel):
    """Default request body of a lane."""

    model_config = ConfigDict(extra="allow")

    agent: str


class RaceDefaults(Answer):
    """Default request body of a race."""

    steps: int
    seed: int
    lanes: list[LaneDefaults]


class DefaultsView(Answer):
    """Default request bodies of a training and of a race, and what features add to them."""

    training: TrainingDefaults
    race: RaceDefaults


class SettingOption(Answer):
    """Declaration of a setting: the labels, limits and default of its form control.

    Attributes:
        valid: the valid values, in words.
        excludes_minimum: whether the minimum itself is not valid.
        excludes_maximum: whether the maximum itself is not valid.
        choices: the valid words, if only certain words are valid.
        choice_titles: the titles of these words, in their order.
        is_live: whether it may change while a training runs.
    """

    title: str
    symbol: str | None
    quantity: str | None
    unit: str | None
    help: str
    valid: str
    minimum: float | None
    maximum: float | None
    excludes_minimum: bool
    excludes_maximum: bool
    is_number: bool
    is_boolean: bool
    is_whole: bool
    choices: list[str]
    choice_titles: list[str]
    default: Value
    is_live: bool


class WorldOption(Described):
    """A named world, with what happens in it."""

    disturbances: list[AnyDisturbance]


class RangesView(Answer):
    """Limits of a field by what is chosen in another: (low, high) of each choice."""

    field: str
    ranges: dict[str, tuple[float, float]]


class FieldOption(SettingOption):
    """Declaration of a field of a disturbance; of a list, that of each of its values.

    Attributes:
        short: its name in a text, such as `limp:legs=1,4:at=25`.
        ranges: narrower limits by the choice of another field.
    """

    short: str
    is_list: bool
    is_required: bool
    ranges: RangesView | None


class DisturbanceOption(Described):
    """A kind of disturbance, with its fields and the simulators that know it.

    Attributes:
        size: the field that says how much happens.
        nothing: the size at which nothing happens: a number, or the robot's part that has it.
        lasts: whether it holds until another of the same thing.
        identified_by: fields that tell, beside the kind, what it changes; each leg is one thing.
        part: part of a leg to which it happens; empty for all of it.
        repairs: whether it only ends what happened before.
        adjective: of a leg to which it has happened: limp, repaired.
    """

    fields: dict[str, FieldOption]
    size: str | None
    nothing: float | str | None
    lasts: bool
    identified_by: list[str]
    part: list[str]
    repairs: bool
    adjective: str
    simulators: list[str]


class AgentOption(Described):
    """An agent, with its constructor's settings and those that can change during a training.

    Attributes:
        searches: whether it plans with a simulator: takes `plans_with`.
        steps_ahead: of a look-ahead agent without settings: how many steps it simulates.
    """

    learns: bool
    searches: bool
    needs_practice: bool
    keeps_learning: bool
    steps_ahead: int | None
    color: str
    settings: dict[str, SettingOption]
    live_settings: dict[str, SettingOption]


class OptionsView(Answer):
    """Options, defaults, limits and help texts of all forms.

    Attributes:
        limits: [lowest, highest]; `settings` says which of them are not valid themselves.
        robots_version: increases with each change of the stored robots.
        titles: names of fields that are no declared settings.
    """

    version: str
    robots_version: Count
    gaits: list[GaitOption]
    robots: list[RobotOption]
    agents: list[AgentOption]
    worlds: list[WorldOption]
    disturbances: list[DisturbanceOption]
    simulators: list[Described]
    observations: list[Described]
    clocks: list[Described]
    defaults: DefaultsView
    settings: dict[str, SettingOption]
    limits: dict[str, tuple[float | None, float | None]]
    help: dict[str, str]
    titles: dict[str, str]
