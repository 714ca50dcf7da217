"""Experiments: the same trainings over many seeds, with intervals in place of single runs."""

import html
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, closing, nullcontext
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from hexapods.arguments import agent_name, plain
from hexapods.domain.errors import InvalidInput
from hexapods.domain.robot import robot
from hexapods.experiments.cluster import ClusterSpec
from hexapods.experiments.config import ExperimentConfig, experiment_config
from hexapods.experiments.engine import Outcome
from hexapods.experiments.folder import open_results
from hexapods.experiments.progress import Progress
from hexapods.experiments.trial import TrialResult
from hexapods.machine import cores
from hexapods.runs.config_json import gait_from_json

if TYPE_CHECKING:
    from hexapods.experiments.report.drawing import Picture


class SettingResult(NamedTuple):
    """What was reached in one setting of an experiment, over its seeds."""

    name: str
    """What differs from the other settings, in words."""
    seeds: int
    iqm_m: float | None
    """Interquartile mean of the distances in 50 steps [m]."""
    low_m: float | None
    high_m: float | None
    """Its 95 % interval by the bootstrap [m]."""


@dataclass(frozen=True, eq=False)
class Experiment:
    """A finished experiment, as `experiment` returns it.

    Attributes:
        config: all that decides its result.
        trials: result of each trial by its key.
        summary: the whole summary, as in the report and in answers of the dashboard.
    """

    config: ExperimentConfig
    trials: Mapping[str, TrialResult] = field(repr=False)
    summary: Mapping[str, Any] = field(repr=False)

    @property
    def settings(self) -> tuple[SettingResult, ...]:
        """The settings and what was reached in each; `pandas.DataFrame(it.settings)` is a table."""
        from hexapods.experiments.names import setting_names  # noqa: PLC0415  # slow to import

        names = setting_names(self.summary["settings"], self.summary["parameters"])
        return tuple(
            SettingResult(
                names[one["key"]],
                one["n"],
                *((one["total"] or {}).get(name) for name in SettingResult._fields[2:]),
            )
            for one in self.summary["settings"]
        )

    def figures(self) -> "list[Picture]":
        """Return the figures of the report, drawn by Matplotlib, with their descriptions."""
        from hexapods.experiments.report.figures import sheets  # noqa: PLC0415  # Matplotlib

        return sheets(self.summary)

    def save_report(self, folder: str | Path) -> Path:
        """Write the report: its page, figures, all trials as CSV, and the summary.

        Returns:
            the path of the page.

        Raises:
            OSError: if a file cannot be written.
        """
        from hexapods.experiments.report.files import write_report  # noqa: PLC0415  # Matplotlib

        return write_report(Path(folder), self.summary, self.trials)

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><th>{html.escape(one.name)}</th><td>{one.seeds}</td><td>{_interval(one)}</td></tr>"
            for one in self.settings
        )
        head = "<tr><th></th><th>seeds</th><th>total, 95 % interval</th></tr>"
        return f"<table><thead>{head}</thead><tbody>{rows}</tbody></table>"


def experiment(
    name: str,
    *,
    folder: str | Path | None = None,
    workers: int | None = None,
    on_trial: Callable[[Outcome], object] | None = None,
    **given: Any,
) -> Experiment:
    """Repeat trainings over many seeds, on all cores, and summarise them with intervals.

    Its trials run in processes, which import the calling program again: in a program call it under
    `if __name__ == "__main__":`.

    Args:
        name: `table1`, `figure4`, `sweep`, `league` or `recovery`; see `ExperimentConfig`.
        folder: keeps each result as soon as it is there; called again with the same folder and
            arguments, the experiment goes on where it ended. None keeps nothing.
        workers: number of processes; None for one per core.
        on_trial: called with each trial's outcome.
        given: fields of `ExperimentConfig` and, in a sweep, lists of values of the agents'
            settings.

    Raises:
        UnknownName, InvalidInput: if an argument is not valid; the message names what is.
        ClusterLost: if the processes cannot be started, or are lost.
    """
    from hexapods.experiments.summary import summarise  # noqa: PLC0415  # SciPy takes a second

    config = experiment_config(name, _read(given))
    spec = ClusterSpec(workers=workers)
    kept: AbstractContextManager[Progress] = (
        nullcontext(Progress(config)) if folder is None else open_results(Path(folder), config)
    )
    with kept as progress:
        with closing(progress.run(progress.remaining(), spec, lambda: True)) as outcomes:
            for outcome in outcomes:
                if on_trial is not None:
                    on_trial(outcome)
        trials, set_aside = progress.planned()
        cost = progress.cost(workers or cores())
    return Experiment(config, trials, summarise(config, trials, set_aside, cost))


def _read(given: Mapping[str, Any]) -> dict[str, Any]:
    """Return fields of an experiment's config: lists as tuples, names in place of classes."""
    values = {
        name: tuple(map(plain, value)) if isinstance(value, list | tuple) else plain(value)
        for name, value in given.items()
    }
    for name in ("agents", "robots", "gaits", "worlds", "observations"):
        if isinstance(values.get(name), str):
            raise InvalidInput(f"{name} is a list, such as [{values[name]!r}]")
    if "agents" in values:
        values["agents"] = tuple(map(agent_name, values["agents"]))
    if "robots" in values:
        values["robots"] = tuple(map(robot, values["robots"]))
    if "gaits" in values:
        gaits = values["gaits"]
        values["gaits"] = tuple(gait_from_json(g) if isinstance(g, Mapping) else g for g in gaits)
    return values


def _interval(one: SettingResult) -> str:
    if one.iqm_m is None:
        return ""
    if one.low_m is None or one.high_m is None:
        return f"{one.iqm_m:.3f} m"
    return f"{one.iqm_m:.3f} m ({one.low_m:.3f} to {one.high_m:.3f})"
