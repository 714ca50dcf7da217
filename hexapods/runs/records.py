"""Records that the training loop and the race loop yield: immutable, in chronological order."""

from dataclasses import dataclass

from hexapods.agents.explanation import Future
from hexapods.domain.short_repr import short_repr
from hexapods.domain.simulator import Motion
from hexapods.domain.types import Action, Cells, FloatArray


@dataclass(frozen=True)
class ActionValues:
    """Action values of a learner in the state in which it is about to act."""

    __repr__ = short_repr

    values: FloatArray
    """(groups, cells) expected return [m], NaN where illegal."""
    visits: FloatArray
    """(groups, cells) visit counts, NaN where illegal."""


@dataclass(frozen=True)
class StepTaken:
    """One step of practice."""

    __repr__ = short_repr

    step: int
    """Counted from 1."""
    episode: int
    """Counted from 0."""
    epsilon: float
    observation: Cells
    """Observation before the action."""
    action: Action
    reward_m: float
    distance_m: float
    """Along the track since the training started."""
    motion: Motion | None
    action_values: ActionValues | None
    """Before the step."""


@dataclass(frozen=True)
class EpisodeEnded:
    """End of an episode, after which ε changes."""

    episode: int
    step: int
    epsilon: float
    reward_m: float
    """Sum over the episode."""


@dataclass(frozen=True)
class Reference:
    """Distance of the one-step look-ahead agent in 50 steps on the same robot: the line to beat.

    Attributes:
        greedy_distance_m: of the one-step look-ahead agent.
        best_known_m: of the best known walk in this world; None where it was not computed.
        baseline: id of the greedy walk, by all that its distance depends on.
    """

    greedy_distance_m: float
    best_known_m: float | None = None
    baseline: str = ""


@dataclass(frozen=True)
class Evaluated:
    """Evaluation after `step` steps of practice: 50 steps from rest at ε = 0."""

    __repr__ = short_repr

    step: int
    epsilon: float
    """ε of the practice at that step."""
    distance_m: float
    motion: Motion | None


@dataclass(frozen=True)
class LaneStep:
    """One step of one lane of a race."""

    __repr__ = short_repr

    lane: int
    step: int
    """Counted from 1."""
    observation: Cells
    action: Action
    reward_m: float
    distance_m: float
    transitions: int
    """Number of transitions simulated for the decision; the step itself does not count."""
    decision_s: float
    """Duration of the decision by the race's timer [s]."""
    motion: Motion
    action_values: ActionValues | None
    futures: tuple[Future, ...] = ()
    """Findings of a search about the actions, in the order in which it made them."""


@dataclass(frozen=True)
class LaneFailed:
    """Failure of a lane: its agent raised, or its physics diverged."""

    __repr__ = short_repr

    lane: int
    step: int
    """The step that failed, counted from 1."""
    reason: str


TrainingRecord = StepTaken | EpisodeEnded | Reference | Evaluated
RaceRecord = LaneStep | LaneFailed
