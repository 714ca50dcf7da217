"""Response models of what runs recorded: curves, tables and walks."""

from app.answer import Answer, Count
from app.events.event_records import Evaluation
from hexapods.domain.gait import AnyGait


class CurveView(Answer):
    """A learning curve with its references: greedy's distance, and the best known one [m].

    Both are of the world as it is now; the best known is null where it was not computed.
    """

    evaluations: list[Evaluation]
    greedy_distance_m: float | None
    best_known_m: float | None


class ThinnedCurve(Answer):
    """A few points of a training's learning curve, by step."""

    id: str
    steps: list[Count]
    distances_m: list[float | None]


class CurvesView(Answer):
    """Thinned learning curves, of the runs that have one, in the order of their ids."""

    curves: list[ThinnedCurve]


class ActionValue(Answer):
    """Value of an action, [pair, cell], in a state, which is the cell of each pair."""

    state: list[int]
    action: tuple[int, int]
    value: float
    visits: Count


class LandingValue(Answer):
    """Value of a landing, which is the cell of each pair when a step has ended."""

    landing: list[int]
    value: float
    visits: Count


class QTableView(Answer):
    """Q-table; `cells` are the (x, y) of each cell [m].

    `values` are those of all legal actions in all states, or of a learner over landings those of
    all landings.
    """

    gait: AnyGait
    divisions: int
    grid_side_m: float
    cells: list[tuple[float, float]]
    values: list[ActionValue] | list[LandingValue]


class RecordedStep(Answer):
    """A recorded step, with the joint positions `qpos` at `time_s` since the motion began."""

    step: Count
    observation: list[int]
    action: tuple[int, int]
    reward_m: float
    distance_m: float
    transitions: Count
    decision_s: float
    time_s: list[float]
    qpos: list[list[float]]


class RecordedLane(Answer):
    """A lane of a recording; `rest_qpos` are the joint positions before the first step."""

    agent: str
    training_id: str | None
    failure: str | None
    rest_qpos: list[float]
    steps: list[RecordedStep]


class RecordingView(Answer):
    """Recording of a race, sufficient to replay it."""

    steps: int
    lanes: list[RecordedLane]
