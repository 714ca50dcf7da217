"""Response models of `/options`, as those of `app.api.answers`."""

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from app.api.answers import Answer, Settings
from hexapods.domain.disturbances import AnyDisturbance
from hexapods.domain.robot import AnyRobot
from hexapods.domain.settings import Value
from hexapods.runs.config import SimulatorName


class Described(Answer):
    """An option of a form, with its name on the page and a one-sentence description."""

    name: str
    title: str
    description: str


class GaitOption(Described):
    """A gait, with the directions of its legs [°] and the pairs of legs that move together."""

    forward_deg: float
    azimuths_deg: list[float]
    pairs: list[tuple[int, int]]


class RobotOption(Described):
    """A robot preset."""

    robot: AnyRobot
    built: dict[str, float] = Field(
        description="parts in whose place a disturbance puts another value, as they were built"
    )


class ExperimentOption(Described):
    """An experiment, with the fields of its request body and their defaults."""

    fields: list[str]
    grid: list[str]
    defaults: dict[str, Any]
    simulator_defaults: dict[str, dict[str, Any]] = Field(
        description="by simulator: the defaults that are others there"
    )
    agents: list[str] = Field(description="the agents that it can compare")


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


class WhatIfDefaults(Answer):
    """The number of seeds of a what-if."""

    seeds: int


class DefaultsView(Answer):
    """Default request bodies of a training and of a race, and the number of seeds of a what-if."""

    training: TrainingDefaults
    race: RaceDefaults
    what_if: WhatIfDefaults


class SettingOption(Answer):
    """Declaration of a setting: the labels, limits and default of its form control."""

    title: str
    symbol: str | None
    quantity: str | None
    unit: str | None
    help: str
    valid: str = Field(description="the valid values, in words")
    minimum: float | None
    maximum: float | None
    excludes_minimum: bool = Field(description="whether the minimum itself is not valid")
    excludes_maximum: bool = Field(description="whether the maximum itself is not valid")
    is_number: bool
    is_boolean: bool
    is_whole: bool
    choices: list[str] = Field(description="the valid words, if only certain words are valid")
    choice_titles: list[str] = Field(description="the titles of these words, in their order")
    default: Value
    is_live: bool = Field(description="whether it may change while a training runs")


class WorldOption(Described):
    """A named world, with what happens in it."""

    disturbances: list[AnyDisturbance]


class RangesView(Answer):
    """Limits of a field by what is chosen in another: (low, high) of each choice."""

    field: str
    ranges: dict[str, tuple[float, float]]


class FieldOption(SettingOption):
    """Declaration of a field of a disturbance; of a list, that of each of its values."""

    short: str = Field(description="its name in a text, such as `limp:legs=1,4:at=25`")
    is_list: bool
    is_required: bool
    ranges: RangesView | None = Field(description="narrower limits by the choice of another field")


class DisturbanceOption(Described):
    """A kind of disturbance, with its fields and the simulators that know it."""

    fields: dict[str, FieldOption]
    size: str | None = Field(description="the field that says how much happens")
    nothing: float | str | None = Field(
        description="the size at which nothing happens: a number, or the robot's part that has it"
    )
    lasts: bool = Field(description="whether it holds until another of the same thing")
    identified_by: list[str] = Field(
        description="fields that tell, beside the kind, what it changes; each leg is one thing"
    )
    part: list[str] = Field(description="part of a leg to which it happens; empty for all of it")
    repairs: bool = Field(description="whether it only ends what happened before")
    adjective: str = Field(description="of a leg to which it has happened: limp, repaired")
    simulators: list[str]


class AgentOption(Described):
    """An agent, with its constructor's settings and those that can change during a training."""

    learns: bool
    searches: bool = Field(description="whether it plans with a simulator: takes `plans_with`")
    needs_practice: bool
    keeps_learning: bool
    steps_ahead: int | None = Field(
        description="of a look-ahead agent without settings: how many steps it simulates"
    )
    color: str
    settings: dict[str, SettingOption]
    live_settings: dict[str, SettingOption]


class ExportOption(Answer):
    """A type of file that a race or training which has ended can be exported as."""

    title: str
    address: str = Field(description="below `/api/v1/runs/{run_id}/`")
    method: Literal["GET", "POST"] = Field(description="of the request; POST is for operators only")
    ending: str
    install: str | None = Field(
        description="the command that installs what the server lacks; null if it lacks nothing"
    )


class OptionsView(Answer):
    """Options, defaults, limits and help texts of all forms."""

    version: str
    gaits: list[GaitOption]
    robots: list[RobotOption]
    agents: list[AgentOption]
    worlds: list[WorldOption]
    disturbances: list[DisturbanceOption]
    simulators: list[Described]
    observations: list[Described]
    clocks: list[Described]
    experiments: list[ExperimentOption]
    defaults: DefaultsView
    settings: dict[str, SettingOption]
    limits: dict[str, tuple[float | None, float | None]] = Field(
        description="[lowest, highest]; `settings` says which of them are not valid themselves"
    )
    help: dict[str, str]
    titles: dict[str, str] = Field(description="names of fields that are no declared settings")
    exports: list[ExportOption] = Field(description="files of a recorded walk")
