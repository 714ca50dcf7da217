"""Records of events about runs and viewers: what the bus sends, by the event's name."""

from dataclasses import field

from app.answer import Answer, Count
from app.events.run_view import NewPace, NewSettings


class Evaluation(Answer):
    """Evaluation of a training: the distance walked [m] after `step` steps of practice."""

    step: Count
    distance_m: float
    epsilon: float


class DeletedRun(Answer):
    """A run that was deleted."""

    id: str


class EvaluationEvent(Evaluation):
    """An evaluation of a training that runs."""

    run_id: str


class ReferenceEvent(Answer):
    """Distances [m] of greedy and of the best known walk on the robot of a training."""

    run_id: str
    greedy_distance_m: float
    best_known_m: float | None


class RatesEvent(Answer):
    """A change of a training's pace and live settings; what stayed is left out."""

    run_id: str
    step: Count
    pace: NewPace = None
    settings: NewSettings = field(default_factory=dict)


class ClockEvent(Answer):
    """The time of the server's clock [s], after a while without other events."""

    sent_s: float


class ViewersEvent(Answer):
    """The number of pages that watch the stage."""

    count: Count


class RobotsEvent(Answer):
    """Stored robots have changed; `GET /options` has them. `count` leaves hidden ones out."""

    count: Count
    version: Count
