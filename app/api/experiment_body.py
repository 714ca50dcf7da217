"""Request body of an experiment."""

from collections.abc import Collection
from dataclasses import fields
from typing import Annotated, Any, ClassVar

from pydantic import Field

from app.api.descriptions import VALID
from app.api.fields import INTEGRAL, Body, Name, SettingsBody, given_settings
from app.jobs.submissions import ExperimentStart
from hexapods.domain.errors import UnknownName
from hexapods.experiments.config import (
    MAX_WORKERS,
    ExperimentConfig,
    ExperimentName,
    experiment_config,
)


class ExperimentBody(Body):
    """An experiment, with the settings of all agents. Omitted fields take its defaults.

    A single value is accepted in place of a list. The fields of `ExperimentConfig` are added to it.
    """

    registered: ClassVar[Collection[str]] = ()
    """Names of the agents that may be compared, once the server has started."""

    experiment: Annotated[ExperimentName, Field(description=VALID["experiment"])]
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
            InvalidInput: if the values are not valid together, or an agent is not registered.
        """
        given: dict[str, Any] = {
            one.name: getattr(self, one.name)
            for one in fields(ExperimentConfig)
            if one.name in type(self).model_fields and one.name not in ("experiment", "settings")
        } | given_settings(self.settings)
        for agent in given["agents"] or ():
            if agent not in self.registered:
                raise UnknownName("agent", agent, self.registered)
        values = {name: tuple(v) if isinstance(v, list) else v for name, v in given.items()}
        config = experiment_config(self.experiment, values)
        return ExperimentStart(config, self.name or None, self.workers)
