"""Response models of experiments: runs, summary, trials, options and events; see `answers`."""

from dataclasses import field
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from app.answer import Answer, Count
from app.api.answers import Page
from app.api.option_answers import Described
from app.events.run_view import DamagedRunView, RunView
from hexapods.domain.observation import Observation
from hexapods.domain.settings import Value
from hexapods.experiments.comparison import Ahead, Outlook, Unit
from hexapods.experiments.config import ExperimentConfig
from hexapods.experiments.presets import Measure
from hexapods.experiments.result import ExperimentResult
from hexapods.runs.lane import PlanningModel

Share = Annotated[float, Field(ge=0, le=1)]
Decided = Literal["yes", "no", "not established"]


class ExperimentView(RunView):
    """An experiment."""

    kind: Literal["experiment"]
    config: ExperimentConfig
    result: ExperimentResult | None
    workers: int | None


class ExperimentPage(Page):
    """Page of experiments."""

    items: list[ExperimentView | DamagedRunView]


class ExperimentOption(Described):
    """An experiment, with the fields of its request body and their defaults.

    Attributes:
        simulator_defaults: by simulator: the defaults that are others there.
        agents: the agents that it can compare.
        about: what it is, in a few words.
        measure: when its learners are evaluated.
        references: agents that are always tried in addition.
        is_timed: whether a race measures decision times in each place.
        is_published: whether the paper prints its numbers.
        takes_settings: whether its agents' settings may have several values.
        earning_steps: steps after each evaluation whose rewards are added up; null where none are.
        paper_gaits: the paper's names of the gaits, where the paper prints its numbers.
    """

    fields: list[str]
    grid: list[str]
    defaults: dict[str, Any]
    simulator_defaults: dict[str, dict[str, Any]]
    agents: list[str]
    about: str
    measure: Measure
    references: list[str]
    is_timed: bool
    is_published: bool
    takes_settings: bool
    earning_steps: Count | None
    paper_gaits: dict[str, str]


class SummaryEvent(Answer):
    """The summary of an experiment has a new number of trials."""

    run_id: str
    done: Count
    total: Count


class WallLane(Answer):
    """A lane of a race that was measured by the wall clock."""

    agent: str
    decision_s: float
    finished_distance_m: float
    elapsed_s: float
    rank: int


class TrialFigures(Answer):
    """Result of a trial; `distances_m` after each block."""

    distances_m: list[float]
    finished_distance_m: float | None
    elapsed_s: float | None
    transitions: Count
    wall: list[WallLane] | None
    failure: str | None
    earned_m: list[float] = field(default_factory=list)


class TrialRow(Answer):
    """A trial; its key is the setting, `#` and the seed's number."""

    key: str
    result: TrialFigures | None
    set_aside: str | None
    compute_s: float


class TrialsView(Answer):
    """The trials so far."""

    trials: list[TrialRow]


class Reason(Answer):
    """Why a trial has no result, with its key and its description in words."""

    key: str
    label: str | None = None
    reason: str


class SummaryCounts(Answer):
    """Number of trials by outcome, with the reasons of those that failed or were set aside.

    `failed` counts both; `done` are all with a result, also those whose walk failed.
    """

    done: Count
    total: Count
    failed: Count
    failures: list[Reason] = field(default_factory=list)
    set_aside: list[Reason]


class Cost(Answer):
    """Computing time of an experiment [s], trials per second, and workers."""

    wall_s: float
    compute_s: float
    trials_per_s: float | None
    workers: int


class Machine(Answer):
    """Machine on which the experiment ran; empty before its start."""

    platform: str = ""
    cores: int | None = None


class Interval95(Answer):
    """Interquartile mean with its 95 % interval, which is null with too few seeds."""

    iqm: float
    low: float | None
    high: float | None


class SharedBy(Answer):
    """A share of the seeds with its 95 % interval."""

    share: Share
    low: float | None
    high: float | None


class Beats(SharedBy):
    """A share of the seeds, and the verdict whether it exceeds one half."""

    verdict: Decided


class Distances(Answer):
    """Distances of the seeds, their mean, median, interquartile mean and 95 % interval [m]."""

    points_m: list[float]
    mean_m: float
    median_m: float
    iqm_m: float
    low_m: float | None
    high_m: float | None


class PublishedView(Answer):
    """Value printed in the paper [m], and its quantile among the seeds."""

    total_m: float | None
    finished_m: float | None
    total_quantile: Share | None
    finished_quantile: Share | None


class Parameters(BaseModel):
    """Parameters of a setting and, by name, its agent's settings; null where the agent has none."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, Value]

    steps_per_episode: int | None


class Named(Parameters):
    """Parameters that identify a setting, without its gait."""

    observation: Observation
    robot: str
    world: str = "flat"
    agent: str
    steps: int
    blocks: int
    divisions: int
    grid_side_m: float
    half_side_m: float


class Measured(BaseModel):
    """Comparisons with the greedy agent and the best known distance; null where undefined."""

    relative: Interval95 | None
    relative_finished: Interval95 | None
    of_best_known: Interval95 | None = None
    walkers: SharedBy | None
    beats_greedy: Beats | None
    beats_greedy_total: Beats | None
    reaches_greedy: SharedBy | None


class SettingView(Measured, Named):
    """Results of a setting over its seeds.

    `seed_numbers` are those of the seeds that have a distance, in the order of the points.
    `is_deterministic`: whether every seed would come equally far.
    """

    key: str
    role: Literal["learner", "reference"]
    gait: str
    n: Count
    seed_numbers: list[Count] | None = None
    is_deterministic: bool | None = None
    failed: Count
    total: Distances | None
    finished: Distances | None
    elapsed_s: float | None
    published: PublishedView | None
    best_known_m: float | None = None


class PooledView(Measured, Named):
    """Results of a setting, pooled over its gaits, with the best known as a share of greedy's."""

    gaits: list[str]
    n: Count
    best_known_relative: float | None = None


class CurveOfSetting(Named):
    """Learning curve of a setting: distances after each block, or on the way in one go [m]."""

    key: str
    gait: str
    greedy_m: float | None
    best_known_m: float | None = None
    iqm_m: list[float]
    low_m: list[float | None]
    high_m: list[float | None]
    mean_m: list[float]
    walkers: list[Share | None]
    points_m: list[list[float]]
    steps: list[int]  # type: ignore[assignment] # steps before each distance


class VersusView(Parameters):
    """Probability that agent `a` walks farther than agent `b`, with its 95 % interval."""

    gait: str
    observation: Observation
    robot: str
    world: str = "flat"
    steps: int
    blocks: int
    divisions: int
    grid_side_m: float
    half_side_m: float
    a: str
    b: str
    probability: Share
    low: float | None
    high: float | None
    verdict: Decided


class BootstrappedView(Answer):
    """A value with its 95 % interval, which is null with too few seeds."""

    value: float
    low: float | None
    high: float | None


class ComparedView(Answer):
    """A setting as it was compared: its name, interquartile mean and number of seeds."""

    name: str
    iqm: BootstrappedView
    seeds: Count
    is_deterministic: bool


class ComparisonWordsView(Answer):
    """A comparison in sentences; one that says nothing is empty."""

    outcome: str
    chance: str
    further: str
    seeds: str


class SettingComparisonView(Answer):
    """Setting `a` compared with setting `b`.

    Attributes:
        a: the first setting.
        b: the second setting.
        difference: of the interquartile means, a − b.
        improvement: probability that a random seed of `a` exceeds a random seed of `b`.
        is_paired: whether both have the same seeds, which were resampled together.
        left_out: number of seeds that only one of two paired settings has.
        ahead: the setting that is ahead, if the interval of the difference excludes 0.
        outlook: what further seeds would bring.
        further_seeds: of each setting, that settle the difference with a chance of 80 % if it is
            as large as it seems; null where none would.
        unit: of the values: metres, half grid sides or shares of greedy's distance.
        is_at_time_out: whether distances are those at time-out.
        words: the same in sentences.
    """

    a: ComparedView
    b: ComparedView
    difference: BootstrappedView
    improvement: BootstrappedView
    is_paired: bool
    left_out: Count
    ahead: Ahead
    outlook: Outlook
    further_seeds: Count | None
    unit: Unit
    is_at_time_out: bool
    words: ComparisonWordsView


class Curve(Answer):
    """Interquartile means over the seeds at some steps, with 95 % intervals [m]."""

    steps: list[int]
    iqm_m: list[float]
    low_m: list[float | None]
    high_m: list[float | None]
    mean_m: list[float]


class Until(Answer):
    """Steps until a share (`of`) of a reference's distance; null if most seeds never get there."""

    of: Share
    median_steps: float | None
    reached: Share
    low: float | None
    high: float | None


class WorldView(Named):
    """An agent in a world of a league or recovery, and the walks of its references [m]."""

    key: str
    role: Literal["learner", "reference"]
    gait: str
    plans_with: PlanningModel | None
    n: Count
    greedy_m: float | None
    greedy_nominal_m: float | None
    best_known_m: float | None
    distance: Interval95
    of_greedy: Interval95 | None
    of_best_known: Interval95 | None
    curve: Curve | None
    mean_m: Interval95 | None
    until_greedy: Until | None
    until_best_known: Until | None
    earned: Curve | None


class TimedView(Answer):
    """A race that was measured by the wall clock."""

    gait: str
    observation: Observation
    robot: str
    lanes: list[WallLane]


class Finding(Answer):
    """Verdict on a claim in one case."""

    observation: Observation
    robot: str
    label: str
    verdict: Literal["holds", "does not hold", "not established", "depends"]
    evidence: str


class ClaimView(Answer):
    """A claim of the paper, with its verdict and the evidence."""

    id: str
    claim: str
    criterion: str
    verdict: Literal["holds", "does not hold", "not established", "depends"]
    evidence: str
    where: list[Finding]


class NarrativeSection(Answer):
    """A short text under a heading."""

    heading: str
    text: str


class ShareLimits(Answer):
    """Limits of the 95 % intervals of 0, 1, … of a number of seeds, as shares of them."""

    seeds: Count
    low: list[Share]
    high: list[Share]


class SummaryView(Answer):
    """Summary of an experiment's trials so far.

    Attributes:
        share_limits: limits of shares of seeds, by which performance profiles have their bands.
        parameters: names of what is varied beside place and agent.
        finding: what came of it, in a sentence; empty where its claims say it.
    """

    format: int
    experiment: str
    config: ExperimentConfig
    versions: dict[str, str]
    machine: Machine
    trials: SummaryCounts
    cost: Cost | None
    parameters: list[str]
    settings: list[SettingView]
    pooled: list[PooledView]
    curves: list[CurveOfSetting]
    versus: list[VersusView]
    timed: list[TimedView]
    worlds: list[WorldView] = field(default_factory=list)
    claims: list[ClaimView]
    story: list[NarrativeSection]
    share_limits: list[ShareLimits] = field(default_factory=list)
    finding: str = ""
