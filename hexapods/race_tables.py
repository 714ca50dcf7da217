"""Races as tables: one row a lane, and one row a step."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from hexapods.domain.world import world_text
from hexapods.result_table import ResultTable
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.recording import LaneRecording
from hexapods.runs.results import RaceResult

_FIGURES = ("reward_m", "distance_m", "transitions", "decision_s")


class Standing(NamedTuple):
    """A lane at the end of a race."""

    rank: int | None
    """Rank by the distance at time-out; None if the race has no time-out."""
    lane: int
    """Number of the lane, from 0 on."""
    agent: str
    finished_distance_m: float | None
    """At time-out, when the first lane has used all its steps [m]."""
    total_distance_m: float | None
    """After all steps [m]; None if it has failed."""
    elapsed_s: float
    """Time that it took by the clock [s]."""


def lane_table(
    config: RaceConfig, result: RaceResult, standings: Iterable[Standing]
) -> ResultTable:
    """Return the lanes of a race in the order of their standings, with all that was raced."""
    walk = {
        "gait": config.resolved_gait.name,
        "world": world_text(config.world),
        "robot": config.robot.name,
        "simulator": config.simulator,
        "tolerance": config.tolerance,
        "reward": config.reward,
    }
    rows = []
    for standing in standings:
        lane, reached = config.lanes[standing.lane], result.lanes[standing.lane]
        rows.append(
            {
                **standing._asdict(),
                **walk,
                "observation": lane.observation,
                "keep_learning": lane.keep_learning,
                "plans_with": reached.plans_with,
                **lane.settings,
                "steps": reached.steps,
                "seed": config.seed,
                "decision_s": reached.decision_s,
                "transitions": reached.simulated_transitions,
                "failure": reached.failure,
            }
        )
    return ResultTable.of(rows)


def step_table(recording: Sequence[LaneRecording]) -> ResultTable:
    """Return all steps of all lanes; see `Race.step_table`."""
    rows = []
    for number, lane in enumerate(recording):
        for index, figures in enumerate(lane.steps.figures):
            cells, (group, cell) = figures["observation"].tolist(), figures["action"].tolist()
            rows.append(
                {
                    "lane": number,
                    "agent": lane.agent,
                    "step": 1 + index,
                    **{f"observed_{at}": observed for at, observed in enumerate(cells)},
                    "group": group,
                    "cell": cell,
                    **{name: figures[name].item() for name in _FIGURES},
                }
            )
    return ResultTable.of(rows)
