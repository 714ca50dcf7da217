"""The tools: each asks the server of the data folder over REST, and shortens its answer."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal
from urllib.parse import quote, urlencode

import numpy as np
from pydantic import BaseModel, Field

from app.cli.server_client import NoServer, call_server
from app.features.mcp.allowance import Allowance
from app.features.mcp.answers import Difference, ExplainedStep, RunList, RunSummary, Started
from app.settings import Settings
from app.storage.server_lock import read_address_file
from hexapods.domain.errors import InvalidInput
from hexapods.domain.gait import DEFAULT_GAIT
from hexapods.experiments.comparing import compare
from hexapods.experiments.comparison import Group
from hexapods.runs.config import RACE_STEPS, TrainingConfig
from hexapods.runs.race_config import MAX_LANES

MOST_LISTED = 50
"""Runs of a page of a listing."""
MOST_COMPARED = 50
"""Trainings of a group that is compared."""
RunId = Annotated[str, Field(description="id of a run, as list_runs has it")]
TrainingIds = Annotated[list[RunId], Field(min_length=1, max_length=MOST_COMPARED)]
Seed = Annotated[int, Field(ge=0, description="the same seed, the same run")]
Gait = Annotated[str, Field(description="such as left-right-origin, tripod, trot, bound")]
Robot = Annotated[str, Field(description="such as stiff, compliant, slippery, dog, or an id")]
World = Annotated[str | None, Field(description="such as flat, ice, slope, stuck-leg")]
RunName = Annotated[str | None, Field(description="by default it says what the run is")]
SimulatorName = Annotated[
    Literal["mujoco", "kinematic"], Field(description="physics, or ideal: without slip")
]


class RacingLane(BaseModel, extra="forbid"):
    """A lane: an agent that looks ahead, or a learner with what it has learned."""

    agent: Annotated[str, Field(description="such as greedy, two-step, q-learning, linear-model")]
    training_id: Annotated[
        str | None, Field(description="of a learner: id of its training; or else practice_steps")
    ] = None
    practice_steps: Annotated[
        int | None, Field(ge=1, description="of a learner: steps that it practises before")
    ] = None


class Tools:
    """Tools that read, and tools that start runs within an allowance."""

    def __init__(self, settings: Settings, allowance: Allowance | None) -> None:
        """Use the server of a data folder; without an allowance nothing can be started."""
        self._settings, self._allowance = settings, allowance

    def list_runs(
        self,
        kind: Annotated[str | None, Field(description="training, race, experiment …")] = None,
        state: Annotated[str | None, Field(description="running, finished, stopped …")] = None,
        search: Annotated[
            str | None, Field(description="a part of id, name, tags or notes")
        ] = None,
        limit: Annotated[int, Field(ge=1, le=MOST_LISTED)] = 20,
        cursor: Annotated[str | None, Field(description="next_cursor of the page before")] = None,
    ) -> RunList:
        """List runs, the newest first, each with its state and its distance."""
        filters = {"kind": kind, "state": state, "search": search}
        page = self._get("runs", limit=limit, cursor=cursor, **filters)
        runs = [RunSummary.of(view) for view in page["items"]]
        return RunList(runs=runs, next_cursor=page["next_cursor"])

    def explain_step(
        self,
        run_id: RunId,
        step: Annotated[int | None, Field(ge=1, description="from 1 on; null: newest")] = None,
        lane: Annotated[int, Field(ge=0, description="of a race, from 0 on")] = 0,
    ) -> ExplainedStep:
        """Explain why a robot made a step: what it brought, why this move, what it missed."""
        path = f"runs/{quote(run_id, safe='')}/explain"
        explanation = self._get(path, step=step, lane=lane)
        update = (explanation["update"] or {}).get("direct") or {}
        names = ExplainedStep.model_fields.keys() - {"rule"}
        shared = {name: explanation[name] for name in names}
        return ExplainedStep(**shared, rule=update.get("numbers"))

    def compare_settings(
        self,
        experiment_id: RunId,
        a: Annotated[str, Field(description="a setting: its key or name, or a part of it")],
        b: Annotated[str, Field(description="another one")],
        distance: Annotated[
            Literal["total", "finished"], Field(description="after 50 steps, or at time-out")
        ] = "total",
        unit: Annotated[
            Literal["m", "h", "greedy"],
            Field(description="metres, half grid sides, or shares of greedy's distance"),
        ] = "m",
    ) -> Difference:
        """Compare two settings of an experiment: the difference a − b with its interval."""
        path = f"experiments/{quote(experiment_id, safe='')}/comparison"
        return Difference.of(self._get(path, a=a, b=b, distance=distance, unit=unit))

    def compare_trainings(self, a: TrainingIds, b: TrainingIds) -> Difference:
        """Compare two groups of trainings that differ in their seeds: the difference a − b.

        A group of one is compared too, but has no interval.
        """
        views = [[self._training(run_id) for run_id in group] for group in (a, b)]
        points = [tuple(map(_distance_m, group)) for group in views]
        seeds = [tuple(view["config"]["seed"] for view in group) for group in views]
        is_paired = set(seeds[0]) == set(seeds[1]) and len(set(seeds[0])) == len(seeds[0])
        is_paired = is_paired and len(seeds[0]) == len(seeds[1])
        first, second = (
            Group(_name(group, side), group_points, numbers if is_paired else None)
            for side, group, group_points, numbers in zip("ab", views, points, seeds, strict=True)
        )
        return Difference.of(compare(first, second, np.random.default_rng(0)).as_json())

    def start_training(
        self,
        *,
        agent: Annotated[str, Field(description="such as q-learning")] = TrainingConfig.agent,
        gait: Gait = DEFAULT_GAIT,
        steps: Annotated[int, Field(ge=1)] = TrainingConfig.steps,
        seed: Seed = TrainingConfig.seed,
        robot: Robot = "stiff",
        world: World = None,
        simulator: SimulatorName = "mujoco",
        settings: Annotated[
            dict[str, float | str | bool] | None,
            Field(description="of the agent, by name, such as alpha"),
        ] = None,
        name: RunName = None,
    ) -> Started:
        """Start a training, which is queued on the server; list_runs shows how far it is."""
        walk = {"gait": gait, "robot": robot, "world": world, "simulator": simulator}
        body = {**walk, "agent": agent, "steps": steps, "seed": seed, "name": name}
        return self._started("trainings", {**body, "settings": settings or {}}, steps)

    def start_race(
        self,
        *,
        lanes: Annotated[list[RacingLane], Field(min_length=1, max_length=MAX_LANES)],
        gait: Gait = DEFAULT_GAIT,
        steps: Annotated[int, Field(ge=1, description="of each lane")] = RACE_STEPS,
        seed: Seed = TrainingConfig.seed,
        robot: Robot = "stiff",
        world: World = None,
        simulator: SimulatorName = "mujoco",
        name: RunName = None,
    ) -> Started:
        """Start a race, with the practice that its lanes need, on the server."""
        walk = {"gait": gait, "robot": robot, "world": world, "simulator": simulator}
        body = {**walk, "steps": steps, "seed": seed, "name": name, "lanes": [*map(_lane, lanes)]}
        practised = [lane.practice_steps or 0 for lane in lanes]
        total = len(lanes) * steps + sum(practised)  # whole numbers
        return self._started("races", body, total)

    def _started(self, kinds: str, body: Mapping[str, Any], steps: int) -> Started:
        if self._allowance is None:
            raise InvalidInput("this server only reads; `hexapods mcp --starts N --steps N` starts")
        with self._allowance.spent(steps):
            view = self._call("POST", f"api/v1/{kinds}", body)
        left = self._allowance
        return Started(run=RunSummary.of(view), starts_left=left.starts, steps_left=left.steps)

    def _training(self, run_id: str) -> dict[str, Any]:
        view: dict[str, Any] = self._get(f"trainings/{quote(run_id, safe='')}")
        return view

    def _get(self, path: str, **query: Any) -> Any:
        parameters = {name: value for name, value in query.items() if value is not None}
        address = f"api/v1/{path}{'?' * bool(parameters)}{urlencode(parameters)}"
        return self._call("GET", address)

    def _call(self, method: str, path: str, body: Mapping[str, Any] | None = None) -> Any:
        """Ask the server.

        Raises:
            InvalidInput: if none runs, or it refuses.
        """
        try:
            return call_server(self._settings, method, path, body)
        except NoServer as error:
            address = read_address_file(self._settings.data)
            where = "" if address is None else f" (there was one at {address})"
            raise InvalidInput(
                f"no server answers for the data folder {self._settings.data}{where}; start it "
                "with `hexapods serve`, or name another folder by --data"
            ) from error


def _lane(lane: RacingLane) -> dict[str, Any]:
    body: dict[str, Any] = {"agent": lane.agent}
    if lane.training_id is not None:
        body["training_id"] = lane.training_id
    if lane.practice_steps is not None:
        body["training"] = {"steps": lane.practice_steps}
    return body


def _distance_m(view: Mapping[str, Any]) -> float:
    distance_m = (view["result"] or {}).get("distance_m")
    if distance_m is None:
        raise InvalidInput(
            f"training {view['id']} is {view['state']} and has no distance; compare trainings "
            "that are finished or stopped, and were not imported"
        )
    return float(distance_m)


def _name(group: list[dict[str, Any]], side: str) -> str:
    """Return what a group is called: the name that all its trainings have, or else its side."""
    names = {view["name"] for view in group}
    return str(names.pop()) if len(names) == 1 else side.upper()
