"""Experiments: the same trainings over many seeds, with intervals in place of single runs."""

import ast
import html
import inspect
import os
import sys
import warnings
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, closing, nullcontext
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, NamedTuple, TypeVar, Union

import numpy as np
from numpy.typing import NDArray

from hexapods.agents.registry import AgentClass
from hexapods.arguments import (
    NOT_GIVEN,
    GaitLike,
    RobotLike,
    agent_name,
    check_callable,
    given_arguments,
    plain,
    read_robot,
    values_of,
)
from hexapods.domain.errors import InvalidInput
from hexapods.domain.gait import read_gait
from hexapods.domain.observation import Observation
from hexapods.domain.records import check_kept
from hexapods.domain.robot_library import RobotLibrary
from hexapods.domain.simulator import RewardKind
from hexapods.domain.text import counted
from hexapods.experiments.cluster import ClusterSpec
from hexapods.experiments.comparison import Comparison, Unit
from hexapods.experiments.config import ExperimentConfig, experiment_config
from hexapods.experiments.failures import failed_trials, failures_sentence
from hexapods.experiments.figures.config import Columns, FigureConfig, Kind
from hexapods.experiments.figures.files import PaperFigure, paper_figure
from hexapods.experiments.folder import open_results
from hexapods.experiments.local_workers import defines_agents
from hexapods.experiments.profiles import Profile
from hexapods.experiments.progress import Progress
from hexapods.experiments.setting_comparison import Distance, compare_settings, profiles_of
from hexapods.experiments.trial import TrialResult
from hexapods.experiments.worker import Outcome
from hexapods.files import path_of
from hexapods.machine import cores
from hexapods.result_table import ResultTable
from hexapods.runs.config import SimulatorName

_FIELDS = tuple(
    field.name
    for field in fields(ExperimentConfig)
    if field.name not in ("experiment", "settings", "blocks")
)
_SINGLE = ("seeds", "seed", "simulator", "tolerance", "reward")
"""Fields that have one value; all others, and settings of agents, have several, or one."""


T = TypeVar("T")
OneOrMore = Union[T, Sequence[T], NDArray[Any]]  # noqa: UP007  # mypy takes no alias of `T | …`


class SettingResult(NamedTuple):
    """Results of one setting of an experiment, over its seeds."""

    name: str
    """Differences from the other settings, in words."""
    seeds: int
    iqm_m: float | None
    """Interquartile mean of the distances in 50 steps [m]."""
    low_m: float | None
    high_m: float | None
    """Its 95 % interval by the bootstrap [m]."""
    failed: int = 0
    """Number of seeds without a distance, because the trial failed."""


@dataclass(frozen=True, eq=False, repr=False)
class Experiment:
    """A finished experiment, as `experiment` returns it.

    Attributes:
        config: all that decides its result.
        trials: result of each trial by its key.
        summary: the whole summary, as in the report and in answers of the dashboard.
    """

    config: ExperimentConfig
    trials: Mapping[str, TrialResult]
    summary: Mapping[str, Any]

    @property
    def settings(self) -> tuple[SettingResult, ...]:
        """The settings and what was reached in each; `pandas.DataFrame(it.settings)` is a table."""
        from hexapods.experiments.names import setting_names  # noqa: PLC0415  # slow to import

        names = setting_names(self.summary["settings"], self.summary["parameters"])
        return tuple(
            SettingResult(
                names[setting["key"]].replace("\u00a0", " "),
                setting["n"],
                **{
                    name: (setting["total"] or {}).get(name)
                    for name in ("iqm_m", "low_m", "high_m")
                },
                failed=setting["failed"],
            )
            for setting in self.summary["settings"]
        )

    def table(self) -> ResultTable:
        """Return all trials, a row each: its agent, gait, world, settings, seed and distances.

        `pandas.DataFrame(experiment.table())` is a data frame, and so is one of polars. A trial
        that failed has no distance, and its `failure` as the reason.
        """
        from hexapods.experiments.trial_rows import trial_rows  # noqa: PLC0415  # slow to import

        set_aside = {row["key"]: row["reason"] for row in self.summary["trials"]["set_aside"]}
        return ResultTable.of(trial_rows(self.config, self.trials, set_aside))

    @property
    def failed(self) -> Mapping[str, str]:
        """Why each trial without a distance failed, by the trial in words."""
        return {trial["label"]: trial["reason"] for trial in failed_trials(self.summary["trials"])}

    def compare(
        self,
        a: str,
        b: str,
        *,
        distance: Distance = "total",
        unit: Unit = "m",
        rng: np.random.Generator | None = None,
    ) -> Comparison:
        """Compare two settings; `print` of the result says it in sentences.

        In a league or recovery all agents of a seed walk with the same robot, so that settings are
        paired by seed. Elsewhere each setting has other random numbers.

        Args:
            a: name of a setting as in `settings`, its key, or a part of it that no other has.
            b: of another one.
            distance: `total`, after 50 steps of its own, or `finished`, at time-out.
            unit: `m`, `h` (half grid sides) or `greedy` (shares of greedy's distance).
            rng: generator of the bootstrap's random numbers; by default that of the experiment's
                seed.

        Raises:
            UnknownName, InvalidInput: if there is no such setting, distance or unit, or a setting
                has no seed with a distance.
        """
        return compare_settings(self.summary, a, b, distance=distance, unit=unit, rng=rng)

    def profile(
        self, *settings: str, distance: Distance = "total", unit: Unit = "m"
    ) -> tuple[Profile, ...]:
        """Return performance profiles: of each setting the share of seeds that reach a distance.

        Args:
            settings: as in `compare`; without any all that have a distance.
            distance: as in `compare`.
            unit: as in `compare`.

        Raises:
            UnknownName, InvalidInput: if there is no such setting, distance or unit, or a setting
                has no seed with a distance.
        """
        return profiles_of(self.summary, settings, distance=distance, unit=unit)

    def figure(
        self,
        *settings: str,
        kind: Kind = "seeds",
        columns: Columns = 1,
        distance: Distance = "total",
        unit: Unit = "m",
    ) -> PaperFigure:
        """Return a figure for a paper, in PDF, SVG and PNG, with caption, data and command.

        It needs the extra `figures`. `save("figure.zip")` writes all files, `save("figure.pdf")`
        the picture alone.

        Args:
            settings: as in `compare`; without any all that have a distance.
            kind: `seeds`, `comparison` (of two settings) or `profile`.
            columns: of a page: 1 (85 mm wide) or 2 (178 mm).
            distance: as in `compare`.
            unit: as in `compare`.

        Raises:
            MissingExtra: if Matplotlib is not installed.
            UnknownName, InvalidInput: if an argument is not valid; the message names what is.
        """
        config = FigureConfig(
            kind=kind, columns=columns, settings=settings, distance=distance, unit=unit
        )
        return paper_figure(self.summary, config)

    def save_report(self, folder: str | os.PathLike[str]) -> Path:
        """Write the report: its page, all trials as CSV, and the summary.

        Returns:
            the path of the page.

        Raises:
            InvalidInput: if the folder is no path.
            OSError: if a file cannot be written.
        """
        from hexapods.experiments.report import files  # noqa: PLC0415  # slow to import

        target = path_of(folder, "a folder")
        return files.write_files(target, files.report_files(self.summary, self.trials))

    def __repr__(self) -> str:
        settings = counted(len(self.summary["settings"]), "setting")
        failures = failures_sentence(self.summary["trials"])
        summary = f"{settings}, {len(self.trials):,} trials{f', {failures}' if failures else ''}"
        return f"<Experiment {self.config.experiment}: {summary}>"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><th>{html.escape(result.name)}</th><td>{result.seeds}</td><td>{_interval(result)}</td></tr>"
            for result in self.settings
        )
        head = "<tr><th></th><th>seeds</th><th>total, 95 % interval</th></tr>"
        failures = html.escape(failures_sentence(self.summary["trials"]))
        caption = f"<caption>{failures}</caption>" if failures else ""
        return f"<table>{caption}<thead>{head}</thead><tbody>{rows}</tbody></table>"


def experiment(
    name: str,
    *,
    folder: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    on_trial: Callable[[Outcome], object] | None = None,
    seeds: int = NOT_GIVEN,
    seed: int = NOT_GIVEN,
    agents: OneOrMore[str | AgentClass] = NOT_GIVEN,
    gaits: OneOrMore[GaitLike] = NOT_GIVEN,
    observations: OneOrMore[Observation] = NOT_GIVEN,
    robots: OneOrMore[RobotLike] = NOT_GIVEN,
    simulator: SimulatorName = NOT_GIVEN,
    steps: OneOrMore[int] = NOT_GIVEN,
    steps_per_episode: OneOrMore[int] = NOT_GIVEN,
    divisions: OneOrMore[int] = NOT_GIVEN,
    grid_side_m: OneOrMore[float] = NOT_GIVEN,
    worlds: OneOrMore[str] = NOT_GIVEN,
    tolerance: float = NOT_GIVEN,
    reward: RewardKind = NOT_GIVEN,
    **settings: Any,
) -> Experiment:
    """Repeat trainings over many seeds, on all cores, and summarise them with intervals.

    Its trials run in processes, which know agents of modules. A program that defines agents itself
    is imported again for them: there, call it under `if __name__ == "__main__":`.

    Args:
        name: of a preset: `table1`, `figure4`, `sweep`, `league`, `recovery`, `groups` or
            `bodies`.
        folder: keeps each result as soon as it is there; called again with the same folder and
            arguments, the experiment goes on where it ended. None keeps nothing.
        workers: number of processes; None for one per core.
        on_trial: called with each trial's outcome.
        seeds: number of seeds for each setting of an agent that learns, 30.
        seed: root seed, from which the seeds of all trials follow.
        agents: names or classes; every combination of what has several values is a setting.
        gaits: as `gait` in `train`.
        observations: how the state is read.
        robots: as `robot` in `train`.
        simulator: `mujoco` (default) or `kinematic`.
        steps: numbers of steps of practice.
        steps_per_episode: numbers of steps for which ε is constant, in a sweep.
        divisions: points along each side of the foot grid, in a sweep.
        grid_side_m: sides of the foot grid [m], in a sweep.
        worlds: names, or disturbances as on the command line, `limp:legs=1,4`; in a league or
            a recovery.
        tolerance: build tolerance of the robots, likewise.
        reward: displacement that a step's reward is, also in a sweep.
        settings: of the agents, in a sweep: `alpha=[0.1, 0.3]`.

    What may have several values is a list, or one value as it is: `steps=500`.

    A trial whose agent raises, or ends its process, has failed: the others go on, and a warning
    says which failed and why, as the result's `failed` does.

    Raises:
        UnknownName, InvalidInput: if an argument is not valid; the message names what is.
        ClusterLost: if the processes cannot be started, or are lost.
        ResultNotStored: if a result cannot be written to the folder.

    Examples:
        >>> import hexapods as hx
        >>> sweep = hx.experiment(
        ...     "sweep", simulator="kinematic", seeds=3, gaits="left-right-origin", steps=20,
        ...     alpha=[0.1, 0.6], workers=1,
        ... )
        >>> for setting in sweep.settings:
        ...     print(setting.name, setting.seeds, round(setting.iqm_m, 2))
        Greedy 1 0.5
        Q-learning, 20 steps, α 0.1 3 0.03
        Q-learning, 20 steps, α 0.6 3 0.04
    """
    fields_and_settings = given_arguments(locals(), _FIELDS, "settings")
    from hexapods.experiments.summary import summarise  # noqa: PLC0415  # slow to import

    check_callable("on_trial", on_trial)
    check_main_module()
    config = check_kept(experiment_config(name, _read(fields_and_settings)), RobotLibrary())
    spec = ClusterSpec(workers=workers)
    opened: AbstractContextManager[Progress] = (
        nullcontext(Progress(config))
        if folder is None
        else open_results(path_of(folder, "a folder"), config)
    )
    with opened as progress:
        with closing(progress.run(progress.remaining(), spec, lambda: True)) as outcomes:
            for outcome in outcomes:
                if on_trial is not None:
                    on_trial(outcome)
        trials, set_aside = progress.planned()
        cost = progress.cost(workers or cores())
    done = Experiment(config, trials, summarise(config, trials, set_aside, cost))
    if done.failed:
        warnings.warn(failures_sentence(done.summary["trials"]), stacklevel=2)
    return done


def check_main_module() -> None:
    """Check that a program which defines agents is not one that its processes would run again.

    Raises:
        InvalidInput: if it has no `if __name__ == "__main__":`.
    """
    if not defines_agents():
        return
    main = sys.modules["__main__"]
    frame, is_running = inspect.currentframe(), False
    while frame is not None and not is_running:
        is_running = frame.f_globals is vars(main) and frame.f_code.co_name == "<module>"
        is_running = is_running and not frame.f_code.co_filename.startswith("<")  # of `python -i`
        frame = frame.f_back
    path = getattr(main, "__file__", None)
    if not is_running or path is None:
        return
    try:
        program = ast.parse(Path(path).read_bytes())
    except (OSError, SyntaxError, ValueError):  # not a source file
        return
    tests = (ast.unparse(node.test) for node in ast.walk(program) if isinstance(node, ast.If))
    if not any("__name__" in test for test in tests):
        raise InvalidInput(
            f"the processes of an experiment import {Path(path).name} again for its agents, which "
            'would begin it again: put the lines that call it under if __name__ == "__main__":'
        )


def _read(fields_and_settings: Mapping[str, Any]) -> dict[str, Any]:
    """Return fields of an experiment's config: lists as tuples, names in place of classes."""
    for name, value in fields_and_settings.items():
        if value is None:
            raise InvalidInput(f"{name} must not be None; leave it out for its default")
    values = {
        name: plain(value) if name in _SINGLE else values_of(value)
        for name, value in fields_and_settings.items()
    }
    readers = {
        "agents": agent_of_processes,
        "robots": read_robot,
        "gaits": read_gait,
        "worlds": _world,
    }
    for name in readers.keys() & values.keys():
        values[name] = tuple(map(readers[name], values[name]))
    return values


def agent_of_processes(agent: str | AgentClass) -> str:
    """Return the name of an agent that the processes of an experiment can import.

    Raises:
        UnknownName, InvalidInput: if there is none, or it is in no file that they could read.
    """
    name = agent_name(agent)
    module_name, _, class_name = name.partition(":")
    module = sys.modules.get(module_name) if class_name else None
    if module is None:
        return name
    how = (
        "which the processes of an experiment cannot import; write it into a module, such as "
        "my_agents.py, and import it from there"
    )
    if module_name == "__main__":
        if class_name not in _classes_of_program():
            raise InvalidInput(
                f"{class_name} is defined in a notebook or at a prompt, or when the "
                f"program runs, {how}"
            )
    elif module.__spec__ is None:
        raise InvalidInput(f"{class_name} is defined in no file, {how}")
    return name


def _classes_of_program() -> set[str]:
    """Return the classes that a process has which imports the calling program, if it has a file."""
    path = getattr(sys.modules["__main__"], "__file__", None)
    try:
        program = ast.parse(b"" if path is None else Path(path).read_bytes())
    except (OSError, SyntaxError, ValueError):  # not a source file
        return set()
    body = [
        node
        for node in program.body
        if not (isinstance(node, ast.If) and "__name__" in ast.unparse(node.test))
    ]
    inner = (statement for node in body for statement in ast.walk(node))
    return {statement.name for statement in inner if isinstance(statement, ast.ClassDef)}


def _world(value: object) -> str:
    if not isinstance(value, str):
        raise InvalidInput(
            f'a world of an experiment is a text such as "ice" or "limp:legs=1,4", not {value!r}'
        )
    return value


def _interval(result: SettingResult) -> str:
    if result.iqm_m is None:
        return ""
    if result.low_m is None or result.high_m is None:
        return f"{result.iqm_m:.3f} m"
    return f"{result.iqm_m:.3f} m ({result.low_m:.3f} to {result.high_m:.3f})"
