"""Runs of a benchmark: for each task, budget and seed a training from scratch and a frozen walk."""

from collections.abc import Callable, Generator, Iterable, Mapping
from contextlib import closing
from dataclasses import dataclass, replace
from typing import NamedTuple

from hexapods.agents.registry import check_problem
from hexapods.assembly import build_simulator
from hexapods.benchmarking.config import BenchmarkConfig
from hexapods.benchmarking.protocol import PLAIN_SEED, BestKnown, Task, tasks_of
from hexapods.domain.errors import HexapodError
from hexapods.domain.kinematics import check_reach
from hexapods.domain.text import message
from hexapods.experiments.cluster import ClusterSpec
from hexapods.experiments.engine import run_trials
from hexapods.experiments.plan import Trial, TrialSetting, trial_seed
from hexapods.experiments.trial import TrialConfig
from hexapods.experiments.worker import Outcome
from hexapods.runs import best_known
from hexapods.runs.config import TrainingConfig, WalkingProblem, problem_of

_LEAGUE = 0
"""Spawn key of the trials' seeds: robots are those of a league of the same root seed."""


class Run(NamedTuple):
    """A run of a benchmark.

    Attributes:
        task: name of the task.
        budget: steps of practice; 0 of an agent that does not learn.
        number: of the seed, from 0.
    """

    task: str
    budget: int
    number: int

    @property
    def key(self) -> str:
        """Unique name of the run."""
        return f"{self.task}/{self.budget}#{self.number}"


class RunResult(NamedTuple):
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
        settings: by budget the setting of its trials; none if the agent cannot walk the task.
        error: why it cannot; None if it can.
    """

    task: Task
    walk: WalkingProblem
    settings: Mapping[int, TrialSetting]
    error: str | None = None


def plan_tasks(config: BenchmarkConfig) -> list[TaskPlan]:
    """Return the tasks of a benchmark, in the protocol's order; nothing is run."""
    return [_task_plan(config, task) for task in tasks_of(config.chosen, config.tasks)]


def _task_plan(config: BenchmarkConfig, task: Task) -> TaskPlan:
    walk = task.walk(config.seed, config.chosen.tolerance)
    check_reach(walk.robot, walk.resolved_gait, walk.grid)
    trainings = {budget: _training(config, walk, budget) for budget in config.budgets}
    try:
        check_problem(config.agent, problem_of(walk), config.settings)
    except HexapodError as error:
        return TaskPlan(task, walk, {}, message(str(error)))
    settings = {
        budget: TrialSetting(
            key=f"{task.name}/{budget}",
            role="learner" if config.learns else "reference",
            robot=walk.robot.name,
            trial=TrialConfig(
                training=training,
                blocks=int(config.learns),
                evaluations=(budget,) if config.learns else (),
            ),
        )
        for budget, training in trainings.items()
    }
    return TaskPlan(task, walk, settings)


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


def runs_of(config: BenchmarkConfig) -> list[Run]:
    """Return all runs: every task and budget with the first seed, then with the next one."""
    return [
        Run(task, budget, number)
        for number in range(config.seeds)
        for task in config.tasks
        for budget in config.budgets
    ]


def run_all(
    config: BenchmarkConfig,
    plans: Iterable[TaskPlan],
    runs: Iterable[Run],
    spec: ClusterSpec,
    may_continue: Callable[[], bool] = lambda: True,
) -> Generator[tuple[Run, RunResult], None, None]:
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
    pending: dict[str, Run] = {}
    trials = []
    for run in runs:
        plan = by_name[run.task]
        if plan.error is not None:
            yield run, RunResult(0.0, plan.error)
            continue
        seed = trial_seed(config.seed, _LEAGUE, run.number)
        trials.append(Trial(run.key, plan.settings[run.budget], run.number, seed))
        pending[run.key] = run
    with closing(run_trials(trials, spec, may_continue)) as outcomes:
        for outcome in outcomes:
            yield pending[outcome.key], _result(outcome)


def _result(outcome: Outcome) -> RunResult:
    if outcome.result is None:
        return RunResult(0.0, message(outcome.set_aside or "it has no result"))
    if outcome.result.failure is not None:
        return RunResult(0.0, message(outcome.result.failure))
    return RunResult(outcome.result.distances_m[-1])


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
        distance_m=round(best_known.search(simulator, width), 6),
        found_by=f"beam search, width {width}",
    )
