"""Lanes of races: their configs, with checks against their agents."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated, Any, Literal

from hexapods.agents import registry
from hexapods.domain.errors import InvalidInput
from hexapods.domain.observation import Observation, check_observation
from hexapods.domain.records import Record
from hexapods.domain.settings import Setting, SettingValues, Value, complete, declared_fields
from hexapods.domain.short_repr import short_repr
from hexapods.runs.config import WalkingProblem, agent_settings

PlanningModel = Literal["world", "start", "nominal"]
"""Model that a search plans with: `world` is the world as it is in each step, `start` as it was at
the start, `nominal` the robot as it was designed, on flat ground."""
PLANNING_MODEL_TITLES: Mapping[PlanningModel, str] = {
    "world": "true model",
    "start": "model of the start",
    "nominal": "nominal model",
}
PlansWith = Annotated[
    PlanningModel,
    Setting(
        title="Plans with",
        help="Model that a search plans with. The true model is the world as it is in each step; "
        "the model of the start (default), the world as it was then; the nominal model, the robot "
        "as it was designed, on flat ground.",
        choice_titles=tuple(PLANNING_MODEL_TITLES.values()),
    ),
]
LaneObservation = Annotated[
    Observation,
    Setting(
        title="Observation",
        help="How the agent reads its state; with a training as in the training.",
        choice_titles=("feet measured", "commands remembered", "feet as planned"),
    ),
]
KeepLearning = Annotated[
    bool,
    Setting(
        title="Keeps learning",
        help="Whether it learns from each step of the race too; without practice it begins there.",
    ),
]


@dataclass(frozen=True, kw_only=True)
class LaneConfig(Record):
    """Config of one lane of a race. `lane_config` adds the agent's defaults.

    Attributes:
        agent: a registered name or `my.module:Agent`.
        observation: observation mode; for a trained agent that of its table.
        keep_learning: whether the agent learns from each step of the race.
        plans_with: model that a search plans with; None means `start`, since later disturbances are
            not announced. `plans_with()` resolves it.
        settings: the agent's settings by name; none for a trained agent, which has those of its
            training.
    """

    __repr__ = short_repr

    agent: str
    observation: LaneObservation = "measured"
    keep_learning: KeepLearning = False
    plans_with: PlansWith | None = None
    settings: SettingValues[Value] = field(default_factory=SettingValues)

    def __post_init__(self) -> None:
        check_observation(self.observation)
        for setting in declared_fields(LaneConfig).values():
            setting.check(getattr(self, setting.name))


LANE_FIELDS = frozenset(declared_fields(LaneConfig))
"""Names of the declared fields of a lane; all other names are settings of its agent."""


def observation_of(
    observation: Observation | None,
    of_training: Observation | None,
    default: Observation = LaneConfig.observation,
) -> Observation:
    """Return the observation mode of a lane.

    Args:
        observation: mode that is requested for the lane; None if none is.
        of_training: mode in which its agent has practised; None without a training.
        default: mode of a lane without a training for which none is requested.

    Raises:
        InvalidInput: if the requested mode contradicts the training.
    """
    if of_training is None:
        return default if observation is None else observation
    if observation not in (None, of_training):
        raise InvalidInput(
            f"observation must be {of_training}, in which its training was learned, not "
            f"{observation}; leave it out, or choose another training"
        )
    return of_training


def lane_config(
    agent: str, *, has_training: bool = False, **fields_and_settings: Any
) -> LaneConfig:
    """Create the config of a lane, with its agent's settings validated and completed.

    Args:
        agent: a registered name or `my.module:Agent`.
        has_training: whether the agent races with what it learned in a training.
        fields_and_settings: fields of `LaneConfig`, without `keep_learning` or with None for the
            agent's default; and the agent's settings by name.

    Raises:
        UnknownName, InvalidInput: if the agent, a setting or a value is invalid.
    """
    lane_fields = {
        name: value for name, value in fields_and_settings.items() if name in LANE_FIELDS
    }
    settings = {
        name: value for name, value in fields_and_settings.items() if name not in LANE_FIELDS
    }
    if lane_fields.get("keep_learning") is None:
        lane_fields["keep_learning"] = registry.keeps_learning(agent)
    lane = LaneConfig(agent=agent, **lane_fields, settings=SettingValues(settings))
    check_lane(lane, has_training)
    if has_training:
        return lane
    return replace(lane, settings=complete(agent_settings(agent), settings, agent))


def plans_with(lane: LaneConfig, walk: WalkingProblem) -> PlanningModel | None:
    """Return the model that a lane's search plans with; None if its agent does not search.

    Where the lane names none, that is the world at the start: `world` where nothing changes later,
    `nominal` where nothing holds at the start, else `start`. No agent is imported: for one that is
    not loaded, as when its package was removed, the lane's own value is returned.
    """
    if lane.plans_with is not None or not registry.is_loaded(lane.agent):
        return lane.plans_with
    try:
        if not registry.searches(lane.agent):
            return None
    except InvalidInput:
        return None  # what has this name now is no agent
    if not walk.world.change_steps:
        return "world"
    return "start" if walk.world.at_start or walk.tolerance else "nominal"


def check_lane(lane: LaneConfig, has_training: bool) -> None:
    """Check a lane against its agent, which is imported.

    Raises:
        UnknownName, InvalidInput: if the agent does not exist, does not learn but should, or does
            not have these settings.
    """
    if lane.keep_learning and not registry.learns(lane.agent):
        raise InvalidInput(
            f"{lane.agent} does not learn, so it cannot keep learning; leave out keep_learning"
        )
    if lane.plans_with is not None and not registry.searches(lane.agent):
        raise InvalidInput(f"{lane.agent} plans with no simulator; leave out plans_with")
    if has_training and lane.settings:
        raise InvalidInput(
            "a lane with training takes its settings from there; leave out "
            + ", ".join(lane.settings)
        )
    if not has_training:
        complete(agent_settings(lane.agent), lane.settings, lane.agent)
