"""The cases of an experiment: each reading of the state on each robot, seen on its own.

The paper does not say which reading it used, and nothing of its servos; so each of its claims is
judged once in each case.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from app.experiments.formatting import READINGS

PAPERS_AGENT = "q-learning"


@dataclass(frozen=True)
class Case:
    """What a summary has for one observation and one robot.

    Attributes:
        observation, robot: which.
        label: in words; the robot only where there are several.
        seed: of every resampling.
        simulator: of all trials.
        settings, pooled, curves, timed: of the summary.
    """

    observation: str
    robot: str
    label: str
    seed: int
    simulator: str
    settings: Sequence[Mapping[str, Any]]
    pooled: Sequence[Mapping[str, Any]]
    curves: Sequence[Mapping[str, Any]]
    timed: Sequence[Mapping[str, Any]]

    def setting(self, gait: str, steps: int, agent: str = PAPERS_AGENT) -> Mapping[str, Any] | None:
        """A setting that has trials."""
        return _first(self.settings, gait=gait, steps=steps, agent=agent)

    def pool(self, steps: int, agent: str = PAPERS_AGENT) -> Mapping[str, Any] | None:
        """An agent over all gaits, if it has trials."""
        return _first(self.pooled, steps=steps, agent=agent)

    def curve(self, gait: str) -> Mapping[str, Any] | None:
        """Q-learning's curve of a gait, if it has trials."""
        found = (c for c in self.curves if (c["gait"], c["agent"]) == (gait, PAPERS_AGENT))
        return next((one for one in found if one["steps"]), None)


def cases(summary: Mapping[str, Any]) -> list[Case]:
    """All of them, in the order of the experiment."""
    places = dict.fromkeys((one["observation"], one["robot"]) for one in summary["settings"])
    several = len({robot for _, robot in places}) > 1
    return [
        Case(
            observation=observation,
            robot=robot,
            label=label(observation, robot if several else None),
            seed=summary["config"]["seed"],
            simulator=summary["config"]["simulator"],
            **{
                part: [
                    one
                    for one in summary[part]
                    if (one["observation"], one["robot"]) == (observation, robot)
                ]
                for part in ("settings", "pooled", "curves", "timed")
            },
        )
        for observation, robot in places
    ]


def label(observation: str, robot: str | None) -> str:
    """`feet read back (stiff robot)`."""
    reading = READINGS.get(observation, observation)
    return (
        reading
        if robot is None
        else f"{reading} ({robot.replace(' (modified)', ', modified')} robot)"
    )


def _first(entries: Sequence[Mapping[str, Any]], **wanted: Any) -> Mapping[str, Any] | None:
    for one in entries:
        if one["n"] and all(one[name] == value for name, value in wanted.items()):
            return one
    return None
