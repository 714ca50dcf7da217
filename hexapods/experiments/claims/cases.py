"""The cases of an experiment: every combination of an observation and a robot.

The paper states neither which observation it used nor how stiff its servos were, so each of its
claims is judged once in each case.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from hexapods.experiments.labels import OBSERVATION_LABELS, robot_name

PAPERS_AGENT = "q-learning"


@dataclass(frozen=True)
class Case:
    """The part of a summary that belongs to one observation and one robot.

    Attributes:
        observation, robot: their names.
        label: display label; it names the robot only where there are several.
        seed: the experiment's seed, used for every resampling.
        simulator: the simulator of all trials.
        parameters: names of the parameters that a sweep varies.
        settings, pooled, curves, timed: this case's entries of the summary's lists; of the curves
            those in blocks, as the paper's are.
        in_one_go: its curves of practices in one go, in which ε falls once.
    """

    observation: str
    robot: str
    label: str
    seed: int
    simulator: str
    parameters: Sequence[str]
    settings: Sequence[Mapping[str, Any]]
    pooled: Sequence[Mapping[str, Any]]
    curves: Sequence[Mapping[str, Any]]
    timed: Sequence[Mapping[str, Any]]
    in_one_go: Sequence[Mapping[str, Any]] = ()

    def setting(self, gait: str, steps: int, agent: str = PAPERS_AGENT) -> Mapping[str, Any] | None:
        """Return a setting's entry, or None if it has no trials yet."""
        return _first_with_trials(self.settings, gait=gait, steps=steps, agent=agent)

    def pool(self, steps: int, agent: str = PAPERS_AGENT) -> Mapping[str, Any] | None:
        """Return an agent's pooled entry over all gaits, or None if it has no trials yet."""
        return _first_with_trials(self.pooled, steps=steps, agent=agent)

    def curve(self, gait: str) -> Mapping[str, Any] | None:
        """Return Q-learning's learning curve in a gait, or None if it has no trials yet."""
        curves = (c for c in self.curves if (c["gait"], c["agent"]) == (gait, PAPERS_AGENT))
        return next((curve for curve in curves if curve["steps"]), None)


def cases_of(summary: Mapping[str, Any]) -> list[Case]:
    """Return all cases of a summary, in the experiment's order."""
    pairs = dict.fromkeys(
        (setting["observation"], setting["robot"]) for setting in summary["settings"]
    )
    several = len({robot for _, robot in pairs}) > 1
    parts = {name: summary[name] for name in ("settings", "pooled", "curves", "timed")}
    parts["curves"] = [curve for curve in summary["curves"] if curve["blocks"] > 1]
    parts["in_one_go"] = [curve for curve in summary["curves"] if curve["blocks"] == 1]
    return [
        Case(
            observation=observation,
            robot=robot,
            label=case_label(observation, robot if several else None),
            seed=summary["config"]["seed"],
            simulator=summary["config"]["simulator"],
            parameters=summary["parameters"],
            **{
                name: [
                    entry
                    for entry in entries
                    if (entry["observation"], entry["robot"]) == (observation, robot)
                ]
                for name, entries in parts.items()
            },
        )
        for observation, robot in pairs
    ]


def case_label(observation: str, robot: str | None) -> str:
    """Return the display label of a case: `feet measured (stiff robot)`."""
    reading = OBSERVATION_LABELS.get(observation, observation)
    return reading if robot is None else f"{reading} ({robot_name(robot)})"


def _first_with_trials(
    entries: Sequence[Mapping[str, Any]], **wanted: Any
) -> Mapping[str, Any] | None:
    for entry in entries:
        if entry["n"] and all(entry[name] == value for name, value in wanted.items()):
            return entry
    return None
