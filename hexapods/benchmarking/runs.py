"""Runs of a benchmark: for each task, budget and seed a training from scratch and a frozen walk."""

from collections.abc import Callable, Generator, Iterable, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from typing import NamedTuple

from hexapods.agents.registry import check_problem, find, parameter_names
from hexapods.assembly import build_simulator
from hexapods.benchmarking.config import BenchmarkConfig
from hexapods.benchmarking.protocol import PLAIN_SEED, BenchmarkTask, BestKnown, tasks_of
from hexapods.domain.errors import HexapodError
from hexapods.domain.kinematics import check_reach
from hexapods.domain.text import message
from hexapods.experiments.cluster import ClusterSpec
from hexapods.experiments.engine import run_trials
from hexapods.experiments.plan import Trial, TrialSetting, trial_seed
from hexapods.experiments.trial import TrialConfig
from hexapods.experiments.worker import Outcome
from hexapods.runs import beam_search
from hexapods.runs.config import TrainingConfig, WalkingProblem, problem_of

_LEAGUE = 0
"""Spawn key of the trials' seeds: robots are those of a league of the same root seed."""


class BenchmarkRun(NamedTuple):
    """A run of a benchmark.

    Attributes:
        task: name of the task.
        budget: steps of practice; 0 of an agent that does not learn.
        number: of the seed, from 0.
    """

    task: str
    budget: int
    number: int


class BenchmarkResult(NamedTuple):
    """Result of a run.

    Attributes:
        distance_m: along the track in 50 steps from rest, without exploring or learning [m]; 0 if
            the run failed.
        error: why it failed, one sentence; None if it did not.
    """

    distance_m: float
    error: str | None = None


@dataclass(frozen=True)
class TaskPlan:
    """A task of a benchmark, with what is needed to run it.

    Attributes:
        task: the task.
        walk: its walking problem.
        error: why the agent cannot walk it; None if it can.
    """

    task: BenchmarkTask
    walk: WalkingProblem
    error: str | None = None


def plan_tasks(config: BenchmarkConfig) -> list[TaskPlan]:
    """Return the tasks of a benchmark, in the protocol's order; nothing is run."""
    return [_task_plan(config, task) for task in tasks_of(config.chosen, config.tasks)]


def _task_plan(config: BenchmarkConfig, task: BenchmarkTask) -> TaskPlan:
    walk = task.walk(config.seed, config.chosen.tolerance)
    check_reach(walk.robot, walk.resolved_gait, walk.grid)
    try:
        check_problem(config.agent, problem_of(walk), config.settings)
    except HexapodError as error:
        return TaskPlan(task, walk, message(str(error)))
    return TaskPlan(task, walk)


def _trial(config: BenchmarkConfig, plan: TaskPlan, runs: Sequence[BenchmarkRun]) -> Trial:
    """Return the trial of runs of a task that differ in their budget only, ascending."""
    budgets = tuple(run.budget for run in runs)
    number = runs[0].number
    setting = TrialSetting(
        key=f"{plan.task.name}/{'+'.join(map(str, budgets))}",
        role="learner" if config.learns else "reference",
        robot=plan.walk.robot.name,
        trial=TrialConfig(
            training=_training(config, plan.walk, budgets[-1]),
            blocks=int(config.learns),
            evaluations=budgets if config.learns else (),
        ),
    )
    seed = trial_seed(config.seed, _LEAGUE, number)
    return Trial(f"{setting.key}#{number}", setting, number, seed)


def _training(config: BenchmarkConfig, walk: WalkingProblem, budget: int) -> TrainingConfig:
    return TrainingConfig(
        **vars(walk.walk()),
        agent=config.agent,
        observation=config.observation,
        settings=config.settings,
        steps=max(1, budget),
        steps_per_episode=config.chosen.steps_per_episode,
        evaluate_every=0,
    )


def runs_of(config: BenchmarkConfig) -> list[BenchmarkRun]:
    """Return all runs: every task and budget with the first seed, then with the next one."""
    return [
        BenchmarkRun(task, budget, number)
        for number in range(config.seeds)
        for task in config.tasks
        for budget in config.budgets
    ]


def run_all(
    config: BenchmarkConfig,
    plans: Iterable[TaskPlan],
    runs: Iterable[BenchmarkRun],
    spec: ClusterSpec,
    may_continue: Callable[[], bool] = lambda: True,
) -> Generator[tuple[BenchmarkRun, BenchmarkResult], None, None]:
    """Run some runs of a benchmark on worker processes, and yield each with its result.

    An agent that raises or ends its process, and physics that diverges, is a result with an error.

    Args:
        config: the benchmark.
        plans: its tasks.
        runs: those to be run.
        spec: the workers.
        may_continue: as of `run_trials`.

    Raises:
        ClusterLost: if no worker can be started.
    """
    by_name = {plan.task.name: plan for plan in plans}
    possible: list[BenchmarkRun] = []
    for run in runs:
        reason = by_name[run.task].error
        if reason is None:
            possible.append(run)
        else:
            yield run, BenchmarkResult(0.0, reason)
    batches = _practised_together(possible) if _ignores_length(config) else [[r] for r in possible]
    while batches:
        trials = [_trial(config, by_name[batch[0].task], batch) for batch in batches]
        pending = {trial.key: batch for trial, batch in zip(trials, batches, strict=True)}
        batches = []
        with closing(run_trials(trials, spec, may_continue)) as outcomes:
            for outcome in outcomes:
                batch = pending[outcome.key]
                results = _results(outcome, len(batch))
                if results is None:
                    batches += [[run] for run in batch]  # shorter ones may succeed
                else:
                    yield from zip(batch, results, strict=True)


def _ignores_length(config: BenchmarkConfig) -> bool:
    """Whether an agent does not know how long it will practise.

    Then what it has learned after some steps of a longer practice is what it learns in a practice
    of so many steps, and one practice serves all budgets.
    """
    return config.learns and "steps" not in parameter_names(find(config.agent))


def _practised_together(runs: Iterable[BenchmarkRun]) -> list[list[BenchmarkRun]]:
    """Return runs by task and seed, each with its budgets ascending."""
    by_practice: dict[tuple[str, int], list[BenchmarkRun]] = {}
    for run in sorted(runs, key=lambda run: (run.number, run.budget)):
        by_practice.setdefault((run.task, run.number), []).append(run)
    return list(by_practice.values())


def _results(outcome: Outcome, count: int) -> list[BenchmarkResult] | None:
    """Return the results of a trial's runs; None if it failed, and has more than one."""
    done = outcome.result
    failure = outcome.set_aside if done is None else done.failure
    if done is not None and failure is None:
        return [BenchmarkResult(distance_m) for distance_m in done.distances_m]
    if count > 1:
        return None
    return [BenchmarkResult(0.0, message(failure or "it has no result"))]


def best_known_of(config: BenchmarkConfig, plan: TaskPlan, threads: int = 1) -> BestKnown:
    """Return the best known distance of a task: the stored one, or of another draw a beam's.

    Args:
        config: the benchmark, with its root seed.
        plan: the task.
        threads: number of threads of the search.

    Raises:
        Diverged: if the physics diverges.
    """
    if plan.task.drawn is None or config.seed == PLAIN_SEED:
        return plan.task.best_known
    width = config.chosen.beam_width
    simulator = build_simulator(replace(plan.walk, tolerance=0.0), threads)
    return BestKnown(
        distance_m=round(beam_search.search(simulator, width, bonus=True), 6),
        found_by=f"beam search with a bonus, width {width}",
    )


def all_best_known(
    config: BenchmarkConfig, plans: Iterable[TaskPlan], threads: int
) -> dict[str, BestKnown | str]:
    """Return `best_known_of` each task by its name, or in its place why there is none."""
    best_known: dict[str, BestKnown | str] = {}
    for plan in plans:
        try:
            best_known[plan.task.name] = best_known_of(config, plan, threads)
        except HexapodError as error:
            best_known[plan.task.name] = message(str(error))
    return best_known
