"""Request bodies with the settings of the registered agents, built when the server starts."""

import re
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal, Union

from pydantic import Field, GetCoreSchemaHandler, create_model
from pydantic_core import core_schema

from app.agents.registry import learns
from app.api.descriptions import VALID
from app.api.experiment_body import ExperimentBody, some
from app.api.fields import Declared
from app.api.schemas import ChangeBody, LaneBody, PracticeBody, RaceBody, TrainingBody
from app.domain.errors import UnknownName
from app.domain.settings import REQUIRED, DeclaredSetting
from app.experiments.config import settings_of
from app.runs.config import MAX_LANES, TrainingConfig, agent_settings, changeable_settings
from app.stage.scene_spec import PAPERS_LANES


class ByAgent:
    """Chooses the model of a body by the agent that the body names.

    A body of an agent that is not registered raises `UnknownName`.
    """

    def __init__(self, models: Mapping[str, type[Any]], default: str | None = None) -> None:
        """Create the choice.

        Args:
            models: by agent.
            default: the agent of a body that names none.
        """
        self._models, self._default = models, default or next(iter(models))

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        choices = {name: handler.generate_schema(model) for name, model in self._models.items()}
        # What is no object, or names no agent where it must, is refused by the default's model.
        return core_schema.tagged_union_schema(choices, discriminator=self._agent_of)

    def _agent_of(self, value: Any) -> str:
        agent = value.get("agent") if isinstance(value, dict) else getattr(value, "agent", None)
        if not isinstance(agent, str):
            return self._default
        if agent not in self._models:
            raise UnknownName("agent", agent, self._models)
        return agent


class AgentBodies:
    """The request bodies of a server.

    Attributes:
        training, race, experiment, change: for `Annotated[TrainingBody, bodies.training]` and so
            on in the signatures of routes.
    """

    def __init__(self, agents: Sequence[str]) -> None:
        """Build them.

        Args:
            agents: the names that are registered.
        """
        practices = {agent: _practice_body(agent) for agent in agents}
        trainings = {agent: _training_body(agent, body) for agent, body in practices.items()}
        lanes = {agent: _lane_body(agent, body) for agent, body in practices.items()}
        self.training = ByAgent(trainings, TrainingConfig.agent)
        self.race = Instead(_race_body(lanes))
        self.experiment = Instead(_experiment_body(agents))
        self.change = Instead(_change_body(agents))


class Instead:
    """Validates by another model than the one that is annotated, which is its base class."""

    def __init__(self, model: type[Any]) -> None:
        self._model = model

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        return handler.generate_schema(self._model)


def _practice_body(agent: str) -> type[PracticeBody]:
    own: dict[str, Any] = {
        name: (_field([one]), ... if one.default is REQUIRED else one.default)
        for name, one in agent_settings(agent).items()
    }
    return create_model(f"{_camel(agent)}Practice", __base__=PracticeBody, **own)


def _training_body(agent: str, practice: type[PracticeBody]) -> type[TrainingBody]:
    named = (_literal(agent), agent if agent == TrainingConfig.agent else ...)
    made: type[TrainingBody] = create_model(
        f"{_camel(agent)}Training",
        __base__=(practice, TrainingBody),  # type: ignore[arg-type]
        __doc__=TrainingBody.__doc__,
        agent=named,
    )
    return made


def _lane_body(agent: str, practice: type[PracticeBody]) -> type[LaneBody]:
    described = Field(description=VALID["training"])
    own: dict[str, Any] = {"training": (Annotated[practice | None, described], None)}
    return create_model(
        f"{_camel(agent)}Lane",
        __base__=LaneBody,
        __doc__=LaneBody.__doc__,
        agent=(_literal(agent), ...),
        **(own if learns(agent) else {}),
    )


def _race_body(lanes: Mapping[str, type[LaneBody]]) -> type[RaceBody]:
    def papers_lanes() -> list[LaneBody]:
        return [
            lanes[agent].model_validate(
                {"agent": agent, **({"training": {}} if learns(agent) else {})}
            )
            for agent in PAPERS_LANES
        ]

    limits = Field(min_length=1, max_length=MAX_LANES, description=VALID["lanes"])
    lane = Annotated[LaneBody, ByAgent(lanes)]
    kind = Annotated[list[lane], limits]
    own: dict[str, Any] = {"lanes": (kind, Field(default_factory=papers_lanes))}
    return create_model("RaceBody", __base__=RaceBody, __doc__=RaceBody.__doc__, **own)


def _experiment_body(agents: Sequence[str]) -> type[ExperimentBody]:
    own: dict[str, Any] = {
        name: (some(_field(declared)), None) for name, declared in settings_of(agents).items()
    }
    doc = ExperimentBody.__doc__
    return create_model("ExperimentBody", __base__=ExperimentBody, __doc__=doc, **own)


def _change_body(agents: Sequence[str]) -> type[ChangeBody]:
    declared: dict[str, list[DeclaredSetting]] = {}
    for agent in agents:
        for name, setting in changeable_settings(agent).items():
            declared.setdefault(name, []).append(setting)
    own: dict[str, Any] = {name: (_field(one) | None, None) for name, one in declared.items()}
    made: type[ChangeBody] = create_model(
        "ChangeBody", __base__=ChangeBody, __doc__=ChangeBody.__doc__, **own
    )
    made.model_config["json_schema_extra"] = {
        "anyOf": [
            {"required": [name], "properties": {name: {"not": {"type": "null"}}}} for name in own
        ]
    }
    return made


def _field(declared: Sequence[DeclaredSetting]) -> Any:
    """The type of a setting, valid as any of the agents that have it declares it."""
    kinds = {(str(one.annotation), one.about): Annotated[Any, Declared(one)] for one in declared}
    return Union[tuple(kinds.values())]  # noqa: UP007 - of as many as there are


def _literal(agent: str) -> Any:
    return Literal[agent]


def _camel(agent: str) -> str:
    return "".join(word.capitalize() for word in re.split(r"[\W_]+", agent))
