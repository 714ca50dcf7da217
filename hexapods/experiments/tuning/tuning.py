"""A tuning: candidates of a search and their trials, then the trials on held-out seeds.

The search sees seeds of its own. What it finds is judged on others, because the best of many
candidates was also the luckiest of them.
"""

from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from dataclasses import replace
from statistics import fmean
from typing import NamedTuple

from hexapods.agents.registry import check_problem
from hexapods.domain.errors import HexapodError, InvalidInput
from hexapods.domain.settings import SettingValues, Value
from hexapods.experiments.plan import Plan, Trial, TrialSetting, trial_seed
from hexapods.experiments.progress import Progress
from hexapods.experiments.trial import TrialConfig, TrialResult
from hexapods.experiments.tuning.config import Objective, TuningConfig
from hexapods.experiments.tuning.study import Study
from hexapods.experiments.worker import Outcome
from hexapods.experiments.worlds import mean_distance_m
from hexapods.runs.config import problem_of

BATCH = 4
"""Candidates that are asked for together, whatever the number of workers, so that this number does
not change the study."""
SEARCH_SEEDS = 1
"""First spawn key of the search's seeds; the held-out ones are those of a league, whose is 0."""
_SAMPLER_SEED = 2

Run = Callable[[Sequence[Trial]], Iterable[Outcome]]
"""Runs trials, and yields each outcome once it is added to the progress."""


class NothingTried(HexapodError):
    """No candidate of the search has results of all its seeds."""


class Candidate(NamedTuple):
    """Values that the study asked for, and what came of them."""

    number: int
    """Number in the study; 0 are the defaults."""
    values: SettingValues[Value]
    """The values that are searched, by name."""
    value_m: float | None = None
    """Mean of the objective over the seeds [m]; a walk that failed counts as 0 m. None if it could
    not be tried."""
    failed: int = 0
    """Number of seeds whose walk failed."""
    reason: str | None = None
    """Why it could not be tried, in a sentence."""


class Tuning:
    """Search of a tuning, and its comparison on held-out seeds.

    Attributes:
        config: the config.
        defaults: setting of the agent with its defaults, on the held-out seeds.
        candidates: the candidates that were tried so far, by number.
        plan: the plan of the held-out seeds; with the tuned settings once they are found.
        total: number of all trials, if no candidate is asked for twice and the best is not the
            defaults.
        is_complete: whether all trials have an outcome.
    """

    def __init__(self, config: TuningConfig) -> None:
        """Plan the tuning; nothing is run.

        Raises:
            InvalidInput, UnknownName, Unreachable: if a setting is invalid, or there are too many
                trials.
        """
        self.config = config
        self.plan = Plan(config)
        self.defaults = next(
            one
            for one in self.plan.settings
            if one.role == "learner" and one.training.agent == config.agent
        )
        self.candidates: list[Candidate] = []
        self.total = config.candidates * config.search_seeds + self.plan.total + config.seeds
        self.is_complete = False

    @property
    def default_values(self) -> SettingValues[Value]:
        """The defaults of the settings that are searched."""
        settings = self.defaults.training.settings
        return SettingValues({one.name: settings[one.name] for one in self.config.search_ranges})

    @property
    def best(self) -> Candidate:
        """The best candidate so far; of several that are equal, the first.

        Raises:
            NothingTried: if there is none.
        """
        tried = [one for one in self.candidates if one.value_m is not None]
        if not tried:
            raise NothingTried(
                "no settings could be tried"
                + (f": {self.candidates[0].reason}" if self.candidates else "")
            )
        return max(tried, key=lambda one: (one.value_m, -one.number))

    @property
    def tuned(self) -> TrialSetting:
        """Setting of the agent with the best values, on the held-out seeds; maybe the defaults."""
        if self.best.values == self.default_values:
            return self.defaults
        return self._setting("tuned", self.best.values, self.defaults.trial.evaluations)

    def search_trials(self, values: SettingValues[Value]) -> list[Trial]:
        """Return the trials of some values in the search.

        Raises:
            InvalidInput: if the values do not go together.
        """
        points = self.defaults.trial.evaluations
        setting = self._setting(
            "search", values, points if self.config.objective == "area" else points[-1:]
        )
        return [
            Trial(f"{setting.key}#{number}", setting, number, seed)
            for number, seed in enumerate(search_seeds(self.config))
        ]

    def run(
        self, progress: Progress, run: Run, retry: bool = False
    ) -> Generator[Outcome, None, None]:
        """Run the remaining trials, and yield each outcome.

        Candidates whose trials have outcomes already are told again, so that a tuning that was
        stopped goes on where it was. It ends early when trials are left without an outcome.

        Args:
            progress: where `run` adds the outcomes.
            run: runs trials.
            retry: whether to run those again that were set aside before.

        Raises:
            NothingTried: if no candidate could be tried.
        """
        study = Study(
            self.config.search_ranges,
            self.default_values,
            trial_seed(self.config.seed, _SAMPLER_SEED, 0),
        )
        while len(self.candidates) < self.config.candidates:
            count = min(BATCH, self.config.candidates - len(self.candidates))
            asked = [self._candidate(*study.ask()) for _ in range(count)]
            trials = [trial for _, own in asked for trial in own]
            yield from run(progress.remaining(retry, of=trials))
            if progress.remaining(of=trials):
                return
            for candidate, own in asked:
                tried = self._judged(candidate, own, progress)
                study.tell(tried.number, tried.value_m)
                self.candidates.append(tried)
        if self.tuned != self.defaults:
            self.plan = Plan(self.config, [self.tuned])
        held_out = list(self.plan.trials())
        yield from run(progress.remaining(retry, of=held_out))
        self.is_complete = not progress.remaining(of=held_out)

    def _candidate(self, number: int, values: Mapping[str, Value]) -> tuple[Candidate, list[Trial]]:
        candidate = Candidate(number, SettingValues(values))
        try:
            return candidate, self.search_trials(candidate.values)
        except InvalidInput as error:
            return candidate._replace(reason=str(error)), []

    def _judged(
        self, candidate: Candidate, trials: Sequence[Trial], progress: Progress
    ) -> Candidate:
        if candidate.reason is not None:
            return candidate
        aside = [progress.set_aside[one.key] for one in trials if one.key in progress.set_aside]
        if aside:
            return candidate._replace(reason=aside[0])
        results = [progress.results[one.key] for one in trials]
        failures = [one.failure for one in results if one.failure is not None]
        if len(failures) == len(results):
            return candidate._replace(reason=failures[0], failed=len(failures))
        return candidate._replace(
            value_m=fmean(
                objective_m(self.config.objective, trials[0].config, one) for one in results
            ),
            failed=len(failures),
        )

    def _setting(
        self, phase: str, values: Mapping[str, Value], evaluations: tuple[int, ...]
    ) -> TrialSetting:
        settings = self.defaults.training.settings | values
        training = replace(self.defaults.training, settings=settings)
        check_problem(self.config.agent, problem_of(training), settings)
        text = "/".join(f"{name}={value}" for name, value in values.items())
        return replace(
            self.defaults,
            key=f"{self.defaults.key}/{phase}/{text}",
            trial=replace(self.defaults.trial, training=training, evaluations=evaluations),
            parameters=self.defaults.parameters | values,
        )


def search_seeds(config: TuningConfig) -> list[int]:
    """Return the seeds of the search; none of them is held out."""
    return [trial_seed(config.seed, SEARCH_SEEDS, number) for number in range(config.search_seeds)]


def objective_m(objective: Objective, config: TrialConfig, result: TrialResult) -> float:
    """Return the objective of a trial [m]; 0 if its walk failed.

    It is the distance of the last evaluation, or the area under the curve divided by its steps.
    """
    if result.failure is not None:
        return 0.0
    if objective == "distance":
        return result.distances_m[-1]
    return mean_distance_m(config.evaluations, result.distances_m)
