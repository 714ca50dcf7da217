"""What a request for an experiment may say."""

from collections.abc import Collection
from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from app.api.fields import Alpha, Body, Epsilon, Gamma, Name, Seed, Steps, number
from app.api.schemas import Gait, GaitBody, check_agent
from app.api.sentences import VALID
from app.domain.grid import MAX_DIVISIONS, MIN_DIVISIONS, MIN_SIDE_M
from app.domain.observation import Observation
from app.domain.robot import robot
from app.experiments.config import (
    GRID,
    MAX_SEEDS,
    ExperimentConfig,
    ExperimentName,
    experiment_config,
)
from app.runs.config import SimulatorName
from app.services.experiment_entry import MAX_WORKERS, ExperimentStart

MAX_VALUES = 100


def _as_list(value: Any) -> Any:
    return value if isinstance(value, list) or value is None else [value]


# One value stands for a list of it.
_SOME = (BeforeValidator(_as_list), Field(min_length=1, max_length=MAX_VALUES))
Divisions = Annotated[int, Field(strict=True, ge=MIN_DIVISIONS, le=MAX_DIVISIONS)]
Side = Annotated[float, number(ge=MIN_SIDE_M)]


class ExperimentBody(Body):
    """An experiment. What is left out has the experiment's own default.

    Where a list is asked for, one value will do.
    """

    experiment: Annotated[ExperimentName, Field(description=VALID["experiment"])]
    name: Name | None = None
    seeds: Annotated[int, Field(strict=True, ge=1, le=MAX_SEEDS, description=VALID["seeds"])] = (
        ExperimentConfig.seeds
    )
    seed: Seed = ExperimentConfig.seed
    gaits: Annotated[list[Gait] | None, *_SOME] = None
    observations: Annotated[list[Observation] | None, *_SOME] = None
    robots: Annotated[list[str | dict[str, Any]] | None, *_SOME] = None
    simulator: SimulatorName = ExperimentConfig.simulator
    agents: Annotated[list[str] | None, *_SOME] = None
    steps: Annotated[list[Steps] | None, *_SOME] = None
    alpha: Annotated[list[Alpha] | None, *_SOME] = None
    gamma: Annotated[list[Gamma] | None, *_SOME] = None
    epsilon_start: Annotated[list[Epsilon] | None, *_SOME] = None
    epsilon_end: Annotated[list[Epsilon] | None, *_SOME] = None
    steps_per_episode: Annotated[list[Steps] | None, *_SOME] = None
    divisions: Annotated[list[Divisions] | None, *_SOME] = None
    grid_side_m: Annotated[list[Side] | None, *_SOME] = None
    workers: Annotated[
        int | None, Field(strict=True, ge=1, le=MAX_WORKERS, description=VALID["workers"])
    ] = None

    def start(self, agents: Collection[str]) -> ExperimentStart:
        """What the service is asked to start.

        Raises:
            InvalidInput: for what cannot be.
        """
        for agent in self.agents or ():
            check_agent(agent, agents)
        given: dict[str, Any] = {
            name: None if values is None else tuple(values)
            for name in ("agents", "observations", *GRID)
            for values in (getattr(self, name),)
        }
        if self.gaits is not None:
            given["gaits"] = tuple(g.spec() if isinstance(g, GaitBody) else g for g in self.gaits)
        if self.robots is not None:
            given["robots"] = tuple(robot(one) for one in self.robots)
        given |= {"seeds": self.seeds, "seed": self.seed, "simulator": self.simulator}
        config = experiment_config(self.experiment, given)
        return ExperimentStart(config, self.name or None, self.workers)
