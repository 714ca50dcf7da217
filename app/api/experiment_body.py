"""Request body of an experiment."""

from collections.abc import Collection
from typing import Annotated, Any, TypeVar

from pydantic import BeforeValidator, Field, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from app.api.descriptions import VALID
from app.api.fields import (
    INTEGRAL,
    Body,
    Divisions,
    GridSide,
    Name,
    RobotBody,
    Seed,
    SettingsBody,
    Steps,
    StepsPerEpisode,
    Tolerance,
    given_settings,
)
from app.api.schemas import Gait, GaitBody
from app.jobs.submissions import ExperimentStart
from hexapods.domain.errors import UnknownName
from hexapods.domain.observation import Observation
from hexapods.domain.robot import robot
from hexapods.experiments.config import (
    MAX_SEEDS,
    MAX_WORKERS,
    ExperimentConfig,
    ExperimentName,
    experiment_config,
)
from hexapods.runs.config import SimulatorName

MAX_VALUES = 100


def _as_list(value: Any) -> Any:
    return value if isinstance(value, list) or value is None else [value]


class _ItemOrList:
    """Adds to the JSON schema that a single item is accepted in place of a list."""

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        kinds = handler(schema)["anyOf"]
        return {"anyOf": [kinds[0]["items"], *kinds]}


T = TypeVar("T")
OneOrMore = Annotated[
    Annotated[
        list[T], Field(min_length=1, max_length=MAX_VALUES, json_schema_extra={"uniqueItems": True})
    ]
    | None,
    BeforeValidator(_as_list),
    _ItemOrList(),
]
"""A list of 1 to `MAX_VALUES` values; a single value is converted to a list."""


def one_or_more(kind: Any) -> Any:
    """Return `OneOrMore` of a type that is built at run time."""
    return OneOrMore[kind]  # type: ignore[misc]


class ExperimentBody(Body):
    """An experiment, with the settings of all agents. Omitted fields take its defaults.

    A single value is accepted in place of a list.
    """

    experiment: Annotated[ExperimentName, Field(description=VALID["experiment"])]
    name: Name | None = None
    seeds: Annotated[
        int,
        Field(strict=True, ge=1, le=MAX_SEEDS, description=VALID["seeds"]),
        INTEGRAL,
    ] = ExperimentConfig.seeds
    seed: Seed = ExperimentConfig.seed
    gaits: OneOrMore[Gait] = None
    observations: OneOrMore[Observation] = None
    robots: OneOrMore[RobotBody] = None
    simulator: SimulatorName = ExperimentConfig.simulator
    agents: OneOrMore[str] = None
    steps: OneOrMore[Steps] = None
    steps_per_episode: OneOrMore[StepsPerEpisode] = None
    divisions: OneOrMore[Divisions] = None
    grid_side_m: OneOrMore[GridSide] = None
    worlds: OneOrMore[str] = None
    tolerance: Tolerance | None = None
    settings: SettingsBody = Field(default_factory=SettingsBody)
    workers: Annotated[
        int | None,
        Field(strict=True, ge=1, le=MAX_WORKERS, description=VALID["workers"]),
        INTEGRAL,
    ] = None

    def start(self, agents: Collection[str]) -> ExperimentStart:
        """Convert to the request of the service.

        Raises:
            InvalidInput: if the values are not valid together, or an agent is not registered.
        """
        for agent in self.agents or ():
            if agent not in agents:
                raise UnknownName("agent", agent, agents)
        given: dict[str, Any] = {
            name: tuple(values) if isinstance(values, list) else values
            for name in type(self).model_fields
            for values in (getattr(self, name),)
            if name not in ("experiment", "name", "workers", "gaits", "robots", "settings")
        }
        if self.gaits is not None:
            given["gaits"] = tuple(g.spec() if isinstance(g, GaitBody) else g for g in self.gaits)
        if self.robots is not None:
            given["robots"] = tuple(robot(one) for one in self.robots)
        given |= {
            name: values and tuple(values) for name, values in given_settings(self.settings).items()
        }
        config = experiment_config(self.experiment, given)
        return ExperimentStart(config, self.name or None, self.workers)
