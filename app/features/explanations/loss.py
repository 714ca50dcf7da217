"""Why a learner with a table loses a race: its tried entries, and better moves it did not make.

In each state of its walk all moves are simulated, one step ahead. The answer tells how much of its
table the learner had tried, what the best moves there would have brought, and why it passed them.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple, Protocol, runtime_checkable

import numpy as np

from app.features.explanations.response_models import LossView
from app.storage.database.store import RunStore
from app.storage.errors import Conflict, NotFound
from app.storage.run import Run
from hexapods.agents.explanation import in_millimetres
from hexapods.agents.landing_table import LandingTable
from hexapods.agents.protocol import Tabular, Valuing
from hexapods.agents.q_table import QTable
from hexapods.assembly import build_simulator, sensor_noise
from hexapods.domain.sums import ordered_sum
from hexapods.domain.text import counted, whole
from hexapods.domain.types import Action, Cells
from hexapods.runs.clocks import Clock
from hexapods.runs.move_comparison import ComparedMove, compare_moves
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.recording import LaneRecording
from hexapods.runs.results import lane_figures
from hexapods.runs.seeding import RACING
from hexapods.runs.walker import Sensors

BETTER_M = 0.001
"""Minimum additional reward in a step of a move that counts as better than the one made [m]."""
LIMIT_S = 20.0
"""Processor time that the simulation of a lane's moves may take [s]."""
PassedOver = Literal["untried", "undervalued", "not chosen"]
"""Why a learner did not make a better move: it had never tried it, its table held the move that it
made for better, or it held the better one for as good and made another one."""


@dataclass(frozen=True)
class WalkedLane:
    """The recorded walk of a lane; can be pickled.

    Attributes:
        config: config of the race.
        number: number of the lane, from 0 on.
        walked: observation and move of each step.
    """

    config: RaceConfig
    number: int
    walked: Sequence[tuple[Cells, Action]]


class Tried(NamedTuple):
    """Counts of the entries of a learner's table that it had tried before its last step.

    Attributes:
        tried, entries: number of tried entries of its table, and of all.
        kind: whether the values are of moves or of landings.
        states: number of different states in which it stood in the race.
        tried_there, moves_there: number of tried moves in these states, and of all.
    """

    tried: int
    entries: int
    kind: Literal["moves", "landings"]
    states: int
    tried_there: int
    moves_there: int


class Deficit(NamedTuple):
    """A lane that is behind in a race; the members as of `LossView`."""

    run_id: str
    lane: int
    agent: str
    clock: Clock
    is_ranked: bool
    ahead: int
    behind_m: float


@runtime_checkable
class ValuedTable(Tabular, Valuing, Protocol):
    """Learner with a table, whose values and visits can be read."""


def standing_of(
    run: Run, lanes: Sequence[LaneRecording], lane: int, steps: int, clock: Clock
) -> Deficit:
    """Return the deficit of a lane to the first one: at time-out, or before by its steps so far.

    Raises:
        Conflict: if the lane is not behind.
    """
    figures = lane_figures(lanes, steps, clock)
    ranked = [figure.finished_distance_m for figure in figures]
    distances_m = [
        recording.distance_m if metres is None else metres
        for recording, metres in zip(lanes, ranked, strict=True)
    ]
    first = distances_m.index(max(distances_m))
    if distances_m[lane] == distances_m[first]:
        raise Conflict(
            f"lane {lane}, {lanes[lane].agent}, is not behind in this race ({clock} clock); only "
            "what loses is asked why",
            run.state,
        )
    return Deficit(
        run_id=run.id,
        lane=lane,
        agent=lanes[lane].agent,
        clock=clock,
        is_ranked=ranked[lane] is not None,
        ahead=first,
        behind_m=distances_m[first] - distances_m[lane],
    )


def practised_steps(store: RunStore, training_id: str | None) -> int | None:
    """Return the steps of a training and of those that it continues; None if one was deleted."""
    steps = 0
    try:
        while training_id is not None:
            training = store.get(training_id)
            steps, training_id = steps + training.done, training.continued_from
    except NotFound:
        return None
    return steps


def simulate(lane: WalkedLane) -> list[ComparedMove]:
    """Simulate all moves in each state of a lane's walk; for a worker process.

    Raises:
        NotRepeated: if the walk cannot be repeated.
        HexapodError: if the physics diverges.
    """
    config, number = lane.config, lane.number
    simulator = build_simulator(config, threads=1)
    sensors = Sensors(simulator, sensor_noise(config.seed, RACING, number))
    return compare_moves(simulator, sensors, config.lanes[number].observation, lane.walked)


def passed_over(agent: Valuing, move: ComparedMove) -> PassedOver | None:
    """Return why the learner, as it was before the step, passed the best move; None if it did not.

    Args:
        agent: the learner.
        move: the move that it made, beside the best one.
    """
    if move.best_reward_m - move.reward_m < BETTER_M:
        return None
    if not agent.visits(move.observation)[move.best]:
        return "untried"
    values = agent.values(move.observation)
    return "undervalued" if values[move.best] < values[move.action] else "not chosen"


def count_tried(agent: ValuedTable, walked: Iterable[Cells]) -> Tried:
    """Count the tried entries of a learner's table: of all, and in the states of a race.

    Args:
        agent: the learner.
        walked: the states in which it stood in the race.
    """
    table, visited = agent.table, list(dict.fromkeys(walked))
    tried_there, moves_there = (
        sum(column)  # whole numbers
        for column in zip(*(_count_tried_moves(agent, cells) for cells in visited), strict=True)
    )
    if isinstance(table, LandingTable):
        tried = sum(visits > 0 for _, _, visits in table.rows())  # whole numbers
        return Tried(tried, table.size, "landings", len(visited), tried_there, moves_there)
    stored: Iterable[Cells] = map(table.cells_at, range(table.states))
    if isinstance(table, QTable):
        stored = (cells for cells, _, _ in table.rows())
    tried = sum(_count_tried_moves(agent, cells)[0] for cells in stored)  # whole numbers
    return Tried(tried, table.size, "moves", len(visited), tried_there, moves_there)


def _count_tried_moves(agent: Valuing, cells: Cells) -> tuple[int, int]:
    """Return the number of tried moves in a state, and of all legal ones."""
    legal = np.isfinite(agent.values(cells))
    return int(np.count_nonzero(agent.visits(cells)[legal])), int(legal.sum())


def loss_view(
    standing: Deficit,
    compared: Sequence[ComparedMove],
    learner_before: Callable[[int], ValuedTable],
    practised_steps: int | None,
) -> LossView:
    """Return why a lane lost, in numbers and in three sentences.

    Args:
        standing: deficit of the lane.
        compared: each step of the lane beside the best move there.
        learner_before: returns the learner as it was before a step, counted from 0; called in
            order.
        practised_steps: steps of practice before the race; None if they are not known.
    """
    reasons = [passed_over(learner_before(n), move) for n, move in enumerate(compared)]
    tried = count_tried(learner_before(len(compared) - 1), (move.observation for move in compared))
    made_m = ordered_sum(move.reward_m for move in compared) / len(compared)
    best_m = ordered_sum(move.best_reward_m for move in compared) / len(compared)
    kinds: Sequence[PassedOver] = ("untried", "undervalued", "not chosen")
    counts = {kind: reasons.count(kind) for kind in kinds}
    better = len(compared) - reasons.count(None)
    return LossView(
        **standing._asdict(),
        **tried._asdict(),
        steps=len(compared),
        practised_steps=practised_steps,
        reward_m=made_m,
        best_reward_m=best_m,
        better_by_m=BETTER_M,
        better=better,
        untried=counts["untried"],
        undervalued=counts["undervalued"],
        not_chosen=counts["not chosen"],
        sentences=[
            about_table(tried, practised_steps),
            about_steps(len(compared), made_m, best_m),
            about_better(len(compared), better, counts),
        ],
    )


def about_table(tried: Tried, practised_steps: int | None) -> str:
    """Return how much of its table a learner had tried, in a sentence."""
    practice = (
        f"In {counted(practised_steps, 'step')} of practice"
        if practised_steps
        else "Before its last step"
    )
    stood = "the state" if tried.states == 1 else f"the {whole(tried.states)} states"
    return (
        f"{practice} it had tried {whole(tried.tried)} of the {whole(tried.entries)} {tried.kind} "
        f"in its table ({100 * tried.tried / tried.entries:.0f} %), and {whole(tried.tried_there)} "
        f"of the {whole(tried.moves_there)} moves in {stood} that it walked through here."
    )


def about_steps(steps: int, made_m: float, best_m: float) -> str:
    """Return what the steps of a lane brought on average beside the best moves, in a sentence."""
    return (
        f"Its {counted(steps, 'step')} brought {in_millimetres(made_m)} each on average; the best "
        f"move from where it stood, simulated, would have brought {in_millimetres(best_m)}."
    )


def about_better(steps: int, better: int, counts: Mapping[PassedOver, int]) -> str:
    """Return in a sentence in how many steps a better move was passed over, and why.

    Args:
        steps: of the lane.
        better: number of those in which the best move was better.
        counts: numbers of these by the reason.
    """
    more = f"{1000 * BETTER_M:g} mm"
    if not better:
        return (
            f"In none of its {counted(steps, 'step')} would another move have brought {more} more: "
            "one step ahead it could do no better."
        )
    reasons: Mapping[PassedOver, str] = {
        "untried": "it had never tried that move",
        "undervalued": "its table held that move for worse",
        "not chosen": "its table held that move for no worse",
    }
    parts = [
        f"in {'each' if counts[kind] == better else counts[kind]} of them {words}"
        for kind, words in reasons.items()
        if counts[kind]
    ]
    return (
        f"In {better} of its {counted(steps, 'step')} the best move would have brought at least "
        f"{more} more than the one it made: {', '.join(parts)}."
    )
