"""Request bodies of experiments."""

from collections.abc import Collection
from dataclasses import fields
from functools import cache
from typing import Annotated, Any, ClassVar, Literal

from pydantic import ConfigDict, Field, create_model

from app.api.agent_bodies import field_of, settings_body
from app.api.descriptions import VALID, one_of
from app.api.fields import (
    INTEGRAL,
    Body,
    Name,
    OneOrMore,
    SettingsBody,
    given_settings,
    record_fields,
    taken_by,
)
from app.features.experiments.start import ExperimentStart
from hexapods.domain.errors import UnknownName
from hexapods.domain.gait import NAMED_GAITS
from hexapods.domain.observation import OBSERVATIONS
from hexapods.domain.text import MAX_NAME
from hexapods.domain.world import lasting_world
from hexapods.experiments.config import (
    MAX_SEEDS,
    MAX_WORKERS,
    ExperimentConfig,
    experiment_config,
    settings_by_name,
)
from hexapods.experiments.presets import PRESETS

VALID.update(
    {
        "experiment": one_of(PRESETS),
        "seeds": f"a whole number from 1 to {MAX_SEEDS:,}",
        "gaits": f"a list, each {one_of(NAMED_GAITS)}, or an object",
        "observations": f"a list, each {one_of(OBSERVATIONS)}",
        "agents": "a list of agents' names; GET /api/v1/options lists them",
        "workers": "a whole number, from 1 to the number of cores",
        "key": "the key of a trial, as GET …/trials has it: the setting and the seed's number",
    }
)


def _enumerate_agents(schema: dict[str, Any], body: "type[ExperimentBody]") -> None:
    """Enumerate the registered agents, which are known only when the server starts."""
    for alternative in schema["properties"]["agents"]["anyOf"]:
        item = alternative.get("items", alternative)
        if item.get("type") == "string":
            item["enum"] = list(body.registered)


class ExperimentBody(Body):
    """An experiment, with the settings of all agents. Omitted fields take its defaults.

    A single value is accepted in place of a list. The fields of `ExperimentConfig` are added to it.
    """

    model_config = ConfigDict(json_schema_extra=_enumerate_agents)
    registered: ClassVar[Collection[str]] = ()
    """Names of the agents that may be compared, once the server has started."""

    experiment: str
    name: Name | None = None
    settings: SettingsBody = Field(default_factory=SettingsBody)
    workers: Annotated[
        int | None,
        Field(strict=True, ge=1, le=MAX_WORKERS, description=VALID["workers"]),
        INTEGRAL,
    ] = None

    def start(self) -> ExperimentStart:
        """Convert to the request of the service.

        Raises:
            InvalidInput: if the values are not valid together.
        """
        by_field: dict[str, Any] = {
            field.name: getattr(self, field.name)
            for field in fields(ExperimentConfig)
            if field.name in type(self).model_fields
            and field.name not in ("experiment", "settings")
        } | given_settings(self.settings)
        values = {name: tuple(v) if isinstance(v, list) else v for name, v in by_field.items()}
        config = experiment_config(self.experiment, values)
        return ExperimentStart(config, self.name or None, self.workers)


class TrialBody(Body):
    """A trial of an experiment."""

    key: Annotated[str, Field(min_length=1, max_length=1000, description=VALID["key"])]


@cache
def experiment_body(agents: tuple[str, ...]) -> type[ExperimentBody]:
    """Return the request body of an experiment, with the settings of the registered agents."""
    lists: dict[str, Any] = {
        name: (OneOrMore[field_of(declared)], None)  # type: ignore[misc]  # it is made here
        for name, declared in settings_by_name(agents).items()
    }
    doc, settings = ExperimentBody.__doc__, settings_body("SettingLists", lists)
    own_fields = record_fields(
        ExperimentConfig, {"experiment", "settings", "blocks"}, optional={"tolerance", "reward"}
    )
    preset_name: Any = Literal[tuple(PRESETS)]
    own_fields["experiment"] = (Annotated[preset_name, Field(description=VALID["experiment"])], ...)

    def check_agent(name: str) -> None:
        if name not in agents:
            raise UnknownName("agent", name[:MAX_NAME], agents)

    for field, check in (("agents", check_agent), ("worlds", lasting_world)):
        names: Any = OneOrMore[Annotated[str, taken_by(check)]]  # type: ignore[misc]
        own_fields[field] = (Annotated[names, Field(description=VALID[field])], None)
    name = "ExperimentBody"
    model = create_model(
        name, __base__=ExperimentBody, __doc__=doc, settings=settings, **own_fields
    )
    model.registered = agents
    return model
