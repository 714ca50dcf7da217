"""Request bodies with the settings of the registered agents, built when the server starts."""

import re
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Annotated, Any, Literal, Union

from pydantic import Field, create_model

from app.api.descriptions import VALID
from app.api.fields import Body, Declared, SettingsBody, named_in, one_of, record_fields
from app.api.schemas import (
    WALK,
    BranchBody,
    ChangeBody,
    LaneBody,
    PracticeBody,
    RaceBody,
    TrainingBody,
)
from hexapods.agents.registry import learns
from hexapods.domain.settings import REQUIRED, DeclaredSetting
from hexapods.runs.config import TrainingConfig, WalkingProblem, agent_settings, changeable_settings
from hexapods.runs.lane import LANE_FIELDS, LaneConfig
from hexapods.runs.race_config import MAX_LANES, RaceConfig
from hexapods.shows.scene_spec import PAPERS_LANES


class AgentBodies:
    """Request bodies of a server, as types for the signatures of routes.

    Attributes:
        training: of a `TrainingBody`.
        race: of a `RaceBody`, or, with `branch_from`, of a `BranchBody`.
        change: of a `ChangeBody`.
    """

    def __init__(self, agents: Sequence[str]) -> None:
        """Build the models.

        Args:
            agents: names of the registered agents.
        """
        practices = {agent: _practice_body(agent) for agent in agents}
        trainings = {agent: _training_body(agent, body) for agent, body in practices.items()}
        lanes = {agent: _lane_body(agent, body) for agent, body in practices.items()}
        self.training: Any = named_in(trainings, "agent", "agent", TrainingConfig.agent)
        self.race: Any = one_of({"race": _race_body(lanes), "branch": BranchBody}, _race_or_branch)
        self.change: Any = _change_body(agents)


@cache
def agent_bodies(agents: tuple[str, ...]) -> AgentBodies:
    """Return the request bodies of the registered agents, which take long to build."""
    return AgentBodies(agents)


def _race_or_branch(value: Any) -> str:
    is_object = isinstance(value, dict)
    is_branch = "branch_from" in value if is_object else isinstance(value, BranchBody)
    return "branch" if is_branch else "race"


def _practice_body(agent: str) -> type[PracticeBody]:
    settings = _settings_of(agent, is_complete=True)
    practice_fields = record_fields(TrainingConfig, {*WALK, "world", "seed", "agent", "settings"})
    name = f"{camel_case(agent)}Practice"
    return create_model(name, __base__=PracticeBody, settings=settings, **practice_fields)


def settings_body(name: str, fields: Mapping[str, Any]) -> tuple[type[SettingsBody], Any]:
    """Return the type and the default of a body's `settings`: required if one of them is."""
    model = create_model(name, __base__=SettingsBody, __doc__=SettingsBody.__doc__, **fields)
    is_required = any(default is ... for _, default in fields.values())
    return model, ... if is_required else Field(default_factory=model)


def _training_body(agent: str, practice: type[PracticeBody]) -> type[TrainingBody]:
    agent_field = (_literal(agent), agent if agent == TrainingConfig.agent else ...)
    model: type[TrainingBody] = create_model(
        f"{camel_case(agent)}Training",
        __base__=(practice, TrainingBody),  # type: ignore[arg-type]
        __doc__=TrainingBody.__doc__,
        agent=agent_field,
        **record_fields(WalkingProblem, {"world"}),
    )
    return model


def _lane_body(agent: str, practice: type[PracticeBody]) -> type[LaneBody]:
    description = Field(description=VALID["training"])
    training: dict[str, Any] = {"training": (Annotated[practice | None, description], None)}
    return create_model(
        f"{camel_case(agent)}Lane",
        __base__=LaneBody,
        __doc__=LaneBody.__doc__,
        agent=(_literal(agent), ...),
        settings=_settings_of(agent, is_complete=False),
        **record_fields(LaneConfig, {"agent", "settings"}, optional=LANE_FIELDS),
        **(training if learns(agent) else {}),
    )


def with_settings_of(agent: str, base: type[Body], suffix: str) -> type[Body]:
    """Return a body with an agent's settings, none of them required, as its `settings`.

    Args:
        agent: name of the agent, the only value of the body's `agent`.
        base: the body without settings.
        suffix: end of the model's name, which begins with the agent's.
    """
    settings = _settings_of(agent, is_complete=False)
    fields: dict[str, Any] = {"agent": (_literal(agent), ...), "settings": settings}
    name = f"{camel_case(agent)}{suffix}"
    return create_model(name, __base__=base, __doc__=base.__doc__, **fields)


@cache
def _settings_of(agent: str, *, is_complete: bool) -> tuple[type[SettingsBody], Any]:
    """Return the type and the default of the settings of an agent.

    Args:
        agent: name of the agent.
        is_complete: whether settings without a default are required; else a training may have them.
            The type is the same for an agent that has none of these.
    """
    settings = agent_settings(agent)
    requires = any(setting.default is REQUIRED for setting in settings.values())
    if not requires and not is_complete:
        return _settings_of(agent, is_complete=True)
    missing = ... if is_complete else None
    fields: dict[str, Any] = {
        name: (field_of([setting]), missing if setting.default is REQUIRED else setting.default)
        for name, setting in settings.items()
    }
    return settings_body(f"{camel_case(agent)}{'' if is_complete else 'Lane'}Settings", fields)


def _race_body(lanes: Mapping[str, type[LaneBody]]) -> type[RaceBody]:
    def papers_lanes() -> list[LaneBody]:
        return [
            lanes[agent].model_validate(
                {"agent": agent, **({"training": {}} if learns(agent) else {})}
            )
            for agent in PAPERS_LANES
        ]

    limits = Field(min_length=1, max_length=MAX_LANES, description=VALID["lanes"])
    lane: Any = named_in(lanes, "agent", "agent")
    kind = Annotated[list[lane], limits]
    fields = record_fields(RaceConfig, {"world", "lanes", "branch_from"})
    fields["lanes"] = (kind, Field(default_factory=papers_lanes))
    return create_model("RaceBody", __base__=RaceBody, __doc__=RaceBody.__doc__, **fields)


def _change_body(agents: Sequence[str]) -> type[ChangeBody]:
    declared: dict[str, list[DeclaredSetting]] = {}
    for agent in agents:
        for name, setting in changeable_settings(agent).items():
            declared.setdefault(name, []).append(setting)
    del declared["pace"]  # a field of its own
    fields: dict[str, Any] = {
        name: (field_of(settings), None) for name, settings in declared.items()
    }
    doc, settings = ChangeBody.__doc__, settings_body("LiveSettings", fields)
    return create_model("ChangeBody", __base__=ChangeBody, __doc__=doc, settings=settings)


def field_of(declared: Sequence[DeclaredSetting]) -> Any:
    """Return the type of a setting: the union of its declarations by the agents that have it."""
    types = {
        (str(setting.annotation), setting.about): Annotated[Any, Declared(setting)]
        for setting in declared
    }
    return Union[tuple(types.values())]  # noqa: UP007 - a union of a variable number of types


def _literal(agent: str) -> Any:
    return Literal[agent]


def camel_case(name: str) -> str:
    """Return a name for a model: `QLearning` of `q-learning`."""
    return "".join(word.capitalize() for word in re.split(r"[\W_]+", name))
