"""The results of a room: by card what was predicted, what came of it, and how both compare."""

import csv
import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, Literal, NamedTuple

from app.features.classroom.questions import Ask, Score, WalkOutcome, scorer
from app.features.classroom.room import Room
from app.features.classroom.room_rows import RoomRun
from app.storage.database.store import RunStore
from app.storage.errors import NotFound
from app.storage.json_text import is_finite
from app.storage.run import Kind, Run, State
from hexapods.domain.text import text_cell
from hexapods.experiments.statistics import Interval, iqm_interval
from hexapods.runs.results import RaceResult, TrainingResult

_SEED_OF_INTERVALS = 0
MEDIA_TYPE = "text/csv"
SCORES = tuple(field.name for field in fields(Score))
"""Names of the figures of a score."""


class ParticipantResult(NamedTuple):
    """A participant's run on a card, or what-if.

    Attributes:
        id: of the run, or the what-if.
        kind: of the run.
        state: of the run; a what-if is kept once it is finished.
        given: settings that the participant gave, by name.
        outcome: what came of it, once it is finished.
        rank: among the seeds by distance, 1 for the longest; None before the reveal.
        answer: of a what-if; its distance is the interquartile mean with the chosen settings.
    """

    id: str
    kind: Kind | Literal["what-if"]
    state: State
    given: dict[str, Any]
    outcome: WalkOutcome
    rank: int | None = None
    answer: Mapping[str, Any] | None = None


class Entry(NamedTuple):
    """A participant's part of a card's results.

    Attributes:
        seed: of the participant.
        name: None where it is not to be seen.
        is_own: whether it is the reader's own.
        prediction: the answer; None without one.
        score: of the answer, after the reveal, and for teachers at any time.
        run: the newest one; None without one.
    """

    seed: int
    name: str | None
    is_own: bool
    prediction: Any
    score: Score | None
    run: ParticipantResult | None


@dataclass(frozen=True)
class CardResults:
    """The results of a card.

    Attributes:
        card: its number.
        title: of the card, or "".
        ask: its question; None without one.
        is_revealed: whether participants see those of others.
        participants: number of those who are in the room, or have left.
        predicted: number of those who have answered.
        finished: number of those whose run has finished.
        entries: of those whom the reader may see, by seed.
        distances_m: of all seeds that the reader may see, shortest first; empty before the reveal
            but for teachers.
        interval: interquartile mean of the distances [m] with its 95 % interval.
        answer: what the lesson says; None before the reveal.
    """

    card: int
    title: str
    ask: Ask | None
    is_revealed: bool
    participants: int
    predicted: int
    finished: int
    entries: list[Entry]
    distances_m: list[float]
    interval: Interval | None
    answer: float | str | None


class Reader(NamedTuple):
    """A reader of results.

    Attributes:
        seed: of the participant who reads; None for others.
        is_teacher: whether what is not revealed is seen.
        is_projector: whether the class reads along, so that only those who are approved are seen.
    """

    seed: int | None
    is_teacher: bool = False
    is_projector: bool = False

    def sees(self, room: Room, seed: int) -> bool:
        """Whether the reader may see a participant, of a card that is open to the reader."""
        is_own = seed == self.seed
        if self.is_teacher and not self.is_projector:
            return True
        return is_own or room.participants[seed].is_approved


def results_of(
    room: Room, store: RunStore, cards: Sequence[int], reader: Reader
) -> list[CardResults]:
    """Return the results of some cards, as a reader may see them.

    Args:
        room: the room.
        store: of its runs.
        cards: numbers of the cards.
        reader: the reader.
    """
    room = room.snapshot()
    return [_card_results(room, store, card, reader) for card in cards]


def as_csv(results: Sequence[CardResults]) -> str:
    """Return results as CSV, without names."""
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(
        [
            *("card", "seed", "prediction", *SCORES),
            *("run_id", "kind", "state", "settings", "distance_m", "winners"),
        ]
    )
    for result in results:
        for entry in result.entries:
            run, score = entry.run, entry.score or Score()
            outcome = WalkOutcome(None) if run is None else run.outcome
            prediction = entry.prediction
            if not isinstance(prediction, str | float | int | None):
                prediction = json.dumps(prediction)
            of_run = [None] * 4 if run is None else [run.id, run.kind, run.state, _text(run.given)]
            row = [
                *(result.card, entry.seed, prediction, *(getattr(score, name) for name in SCORES)),
                *(*of_run, outcome.distance_m, " ".join(outcome.winners)),
            ]
            writer.writerow([text_cell(cell) if isinstance(cell, str) else cell for cell in row])
    return file.getvalue()


def _text(given: dict[str, Any]) -> str:
    return json.dumps(given) if given else ""


def _card_results(room: Room, store: RunStore, card: int, reader: Reader) -> CardResults:
    newest = {seed: _newest(room, store, seed, card) for seed in sorted(room.participants)}
    runs = {seed: run for seed, run in newest.items() if run is not None}
    ended = {seed: run.outcome for seed, run in runs.items() if run.state == "finished"}
    seen = [outcome for seed, outcome in ended.items() if reader.sees(room, seed)]
    ranked = sorted(outcome.distance_m for outcome in seen if outcome.distance_m is not None)
    is_open = reader.is_teacher or card in room.revealed
    shown = room.lesson.cards[card]
    score = shown.ask and scorer(shown.ask, shown.revealed.answer, seen)
    entries = []
    for seed, participant in sorted(room.participants.items()):
        is_own = seed == reader.seed
        if not is_own and not (is_open and reader.sees(room, seed)):
            continue
        is_named = is_own or (reader.is_teacher and not reader.is_projector)
        name = participant.name if is_named else room.name_for_others(seed)
        prediction, run = room.predictions.get((seed, card)), runs.get(seed)
        if run is not None and is_open and run.outcome.distance_m is not None:
            over = sum(distance_m > run.outcome.distance_m for distance_m in ranked)
            run = run._replace(rank=1 + over)
        scored = score(prediction) if score and prediction is not None and is_open else None
        entries.append(Entry(seed, name, is_own, prediction, scored, run))
    return CardResults(
        card=card,
        title=shown.title or "",
        ask=shown.ask,
        is_revealed=card in room.revealed,
        participants=len(room.participants),
        predicted=sum(number == card for _, number in room.predictions),
        finished=len(ended),
        entries=entries,
        distances_m=ranked if is_open else [],
        interval=_interval(ranked) if is_open and ranked else None,
        answer=shown.revealed.answer if is_open else None,
    )


def _interval(distances_m: Sequence[float]) -> Interval:
    return iqm_interval((tuple(distances_m),), _SEED_OF_INTERVALS)


def _newest(room: Room, store: RunStore, seed: int, card: int) -> ParticipantResult | None:
    """Return what a participant started last on a card, of what is still there.

    One that has finished goes before one that has not.
    """
    newest: ParticipantResult | None = None
    for room_run in room.runs_of(seed, card):
        result = _result(room, room_run, store)
        if result is not None and (
            newest is None or newest.state != "finished" or result.state == "finished"
        ):
            newest = result
    return newest


def _result(room: Room, room_run: RoomRun, store: RunStore) -> ParticipantResult | None:
    finished: ParticipantResult | None = room.finished.get(room_run.run_id)
    if finished is not None:
        return finished  # a run that has finished changes no more, and a class asks again and again
    if room_run.answer is not None:
        outcome = WalkOutcome(room_run.answer["chosen"]["iqm_m"])
        return ParticipantResult(
            room_run.run_id,
            "what-if",
            "finished",
            dict(room_run.given),
            outcome,
            answer=room_run.answer,
        )
    try:
        run = store.find(room_run.run_id)
    except NotFound:
        return None  # deleted, or never stored
    if not isinstance(run, Run):
        return None
    result = ParticipantResult(
        run.id, run.kind, run.state, dict(room_run.given), _outcome(run, store)
    )
    if run.state == "finished":
        room.finished[room_run.run_id] = result
    return result


def _outcome(run: Run, store: RunStore) -> WalkOutcome:
    match run.result:
        case TrainingResult(distance_m=distance_m):
            curve = [(row["step"], row["distance_m"]) for row in store.curves.get(run.id)]
            return WalkOutcome(distance_m, curve=[(x, y) for x, y in curve if is_finite(y)])
        case RaceResult(lanes=lanes):
            learner = next(
                (n for n, training_id in enumerate(run.lane_training_ids) if training_id), 0
            )
            figures = [lane.clocks.paper for lane in lanes]
            winners = [lane.agent for lane in lanes if lane.clocks.paper.rank == 1]
            return WalkOutcome(figures[learner].finished_distance_m, tuple(dict.fromkeys(winners)))
    return WalkOutcome(None)
