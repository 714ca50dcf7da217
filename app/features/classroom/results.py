"""Results of a room: by card the predictions, the outcomes of the runs, and their scores."""

import csv
import io
import json
from collections.abc import Callable, Sequence
from dataclasses import fields, replace
from typing import Annotated, Any, Literal, NamedTuple

from annotated_types import Ge
from pydantic import JsonValue

from app.answer import Answer, Count
from app.api.answers import ComparisonView
from app.api.run_views import KindName
from app.features.classroom.class_race import ClassRaceView, Finisher, class_race_of
from app.features.classroom.gain import GainView, Knowledge, class_gain, knowledge_in
from app.features.classroom.questions import Ask, Score, WalkOutcome, scorer
from app.features.classroom.room import Room
from app.features.classroom.room_rows import RoomRun
from app.storage.database.store import RunStore
from app.storage.errors import NotFound
from app.storage.json_text import is_finite
from app.storage.run import Run, State
from hexapods.domain.text import text_cell
from hexapods.experiments.statistics import iqm_interval
from hexapods.runs.results import RaceResult, TrainingResult

_SEED_OF_INTERVALS = 0
MEDIA_TYPE = "text/csv"
SCORES = tuple(field.name for field in fields(Score))
"""Names of the figures of a score."""


class RunOutcome(Answer):
    """A participant's run on a card.

    Attributes:
        id: id of the run, or of the record of a what-if.
        given: settings that the participant gave, by name.
        distance_m: distance that the robot walked; of a race that of the learner at time-out; of a
            what-if the interquartile mean with the chosen settings.
        winners: agents of the lanes that won a race.
        rank: rank among the seeds, 1 for the longest distance; null before the reveal.
        answer: answer of the reader's own what-if; null for other runs.
    """

    id: str
    kind: KindName | Literal["what-if"]
    state: State
    given: dict[str, Any]
    distance_m: float | None
    winners: list[str]
    rank: Annotated[int, Ge(1)] | None
    answer: ComparisonView | None


class ResultEntry(Answer):
    """A participant's part of a card's results.

    Attributes:
        name: name of the participant; null where it is hidden from the reader.
        score: score of the prediction; participants get it after the reveal.
        gain: of the question after the lesson, 1 if the participant was wrong before and is right
            now, -1 if it is the other way round, else 0; null unless both are answered, and for
            others before the reveal.
    """

    seed: Count
    name: str | None
    is_own: bool
    prediction: JsonValue
    score: Score | None
    gain: Literal[-1, 0, 1] | None
    run: RunOutcome | None


class IntervalView(Answer):
    """Interquartile mean of the distances [m] with its 95 % interval, from three seeds on."""

    iqm_m: float
    low_m: float | None
    high_m: float | None


class CardResultsView(Answer):
    """The results of a card, as far as the reader may see them.

    Attributes:
        participants, predicted, finished: number of participants, of those who have answered, and
            of those whose run has finished.
        entries: entries of the participants; before the reveal a participant gets their own alone.
        distances_m: distances of all seeds, shortest first; before the reveal for a teacher alone.
        answer: answer that the lesson gives; null before the reveal, but for a teacher.
        on_their_way: number of finished runs that a projector does not tell yet, as the phones of
            their participants still show them.
        race: race of the best, the median and the last robot; null before the reveal.
    """

    card: Count
    title: str
    ask: Ask | None
    is_revealed: bool
    participants: Count
    predicted: Count
    finished: Count
    entries: list[ResultEntry]
    distances_m: list[float]
    interval: IntervalView | None
    answer: float | str | None
    on_their_way: Count
    race: ClassRaceView | None


class ResultsView(Answer):
    """The results of a room, by card.

    Attributes:
        gain: what the class gains by the lesson; null before the question after it is revealed,
            but for a teacher.
    """

    code: str
    gain: GainView | None
    cards: list[CardResultsView]


class _Run(NamedTuple):
    """The newest run, or what-if, of a participant on a card, with its outcome."""

    shown: RunOutcome
    outcome: WalkOutcome


class Reader(NamedTuple):
    """A reader of results.

    Attributes:
        seed: seed of the participant who reads; None for others.
        is_teacher: whether the reader sees the results of cards that are not revealed.
        is_projector: whether the class reads along, so that only approved participants are seen,
            and before the reveal only runs that their participants have seen.
        is_on_phone: whether a participant's page is open, by seed.
    """

    seed: int | None
    is_teacher: bool = False
    is_projector: bool = False
    is_on_phone: Callable[[int], bool] = lambda seed: False  # noqa: ARG005

    def sees(self, room: Room, seed: int) -> bool:
        """Whether the reader may see a participant, of a card that is open to the reader."""
        is_own = seed == self.seed
        if self.is_teacher and not self.is_projector:
            return True
        return is_own or room.participants[seed].is_approved

    def waits_for(self, room: Room, seed: int, run: RunOutcome, card: int) -> bool:
        """Whether a finished run is not told yet: its participant's phone still shows it."""
        if not self.is_projector or card in room.revealed or run.kind == "what-if":
            return False
        return run.id not in room.watched and self.is_on_phone(seed)

    def sees_gain(self, room: Room) -> bool:
        """Whether the reader may see what the class knew before and after the lesson."""
        is_told = room.knowledge_cards is not None and room.knowledge_cards[1] in room.revealed
        return is_told or (self.is_teacher and not self.is_projector)


def results_of(room: Room, store: RunStore, cards: Sequence[int], reader: Reader) -> ResultsView:
    """Return the results of some cards, as a reader may see them.

    Args:
        room: the room.
        store: store of its runs.
        cards: numbers of the cards.
        reader: the reader.
    """
    room = room.snapshot()
    views = [_card_results(room, store, card, reader) for card in cards]
    knowledge = knowledge_in(room) if reader.sees_gain(room) else {}
    seen = {seed: known for seed, known in knowledge.items() if reader.sees(room, seed)}
    return ResultsView(code=room.code, gain=class_gain(seen), cards=views)


def finishers_of(room: Room, store: RunStore, card: int) -> list[Finisher]:
    """Return the finished runs of a card of the participants whom the class may see."""
    room = room.snapshot()
    newest = {
        seed: _newest(room, store, seed, card)
        for seed, participant in sorted(room.participants.items())
        if participant.is_approved
    }
    return [
        Finisher(seed, run.shown.id, run.outcome.distance_m)
        for seed, run in newest.items()
        if run is not None
        and run.shown.state == "finished"
        and run.shown.kind != "what-if"
        and run.outcome.distance_m is not None
    ]


def as_csv(results: ResultsView) -> str:
    """Return results as CSV, without names; its last row is the class's gain, if there is one."""
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(
        [
            *("card", "seed", "prediction", *SCORES),
            *("run_id", "kind", "state", "settings", "distance_m", "winners"),
            *("gain", "gain_low", "gain_high"),
        ]
    )
    for result in results.cards:
        for entry in result.entries:
            run, score = entry.run, entry.score or Score()
            prediction = entry.prediction
            if not isinstance(prediction, str | float | int | None):
                prediction = json.dumps(prediction)
            row = [
                *(result.card, entry.seed, prediction, *(getattr(score, name) for name in SCORES)),
                *([None] * 5 + [""] if run is None else _cells(run)),
                *(entry.gain, None, None),
            ]
            writer.writerow([text_cell(cell) if isinstance(cell, str) else cell for cell in row])
    if results.gain is not None:
        gain = results.gain
        of_class = [results.cards[-1].card, "class", *[None] * (1 + len(SCORES) + 6)]
        writer.writerow([*of_class, gain.gain, gain.low, gain.high])
    return file.getvalue()


def _cells(run: RunOutcome) -> list[Any]:
    settings = json.dumps(run.given) if run.given else ""
    return [run.id, run.kind, run.state, settings, run.distance_m, " ".join(run.winners)]


def _card_results(room: Room, store: RunStore, card: int, reader: Reader) -> CardResultsView:
    newest = {seed: _newest(room, store, seed, card) for seed in sorted(room.participants)}
    runs = {seed: run for seed, run in newest.items() if run is not None}
    finished = {seed: run for seed, run in runs.items() if run.shown.state == "finished"}
    waiting = {s for s, run in finished.items() if reader.waits_for(room, s, run.shown, card)}
    ended = {seed: run.outcome for seed, run in finished.items() if seed not in waiting}
    seen = [outcome for seed, outcome in ended.items() if reader.sees(room, seed)]
    ranked = sorted(outcome.distance_m for outcome in seen if outcome.distance_m is not None)
    is_open = reader.is_teacher or card in room.revealed
    shown = room.deck[card]
    knowledge = knowledge_in(room) if reader.sees_gain(room) else {}
    is_after = room.knowledge_of(card) == "after"
    score = shown.ask and scorer(shown.ask, shown.revealed.answer, seen)
    entries = []
    for seed, participant in sorted(room.participants.items()):
        is_own = seed == reader.seed
        if not is_own and not (is_open and reader.sees(room, seed)):
            continue
        is_named = is_own or (reader.is_teacher and not reader.is_projector)
        name = participant.name if is_named else room.name_for_others(seed)
        prediction, run = room.predictions.get((seed, card)), runs.get(seed)
        outcome = None if run is None or seed in waiting else run.shown
        if outcome is not None and is_open and outcome.distance_m is not None:
            over = sum(distance_m > outcome.distance_m for distance_m in ranked)
            outcome = replace(outcome, rank=1 + over)
        if outcome is not None and not is_own:
            outcome = replace(outcome, answer=None)
        scored = score(prediction) if score and prediction is not None and is_open else None
        entry = ResultEntry(
            seed=seed,
            name=name,
            is_own=is_own,
            prediction=prediction,
            score=scored,
            gain=knowledge.get(seed, Knowledge(None, None)).gain if is_after else None,
            run=outcome,
        )
        entries.append(entry)
    return CardResultsView(
        card=card,
        title=shown.title or "",
        ask=shown.ask,
        is_revealed=card in room.revealed,
        participants=len(room.participants),
        predicted=sum(number == card for _, number in room.predictions),
        finished=len(finished),
        entries=entries,
        distances_m=ranked if is_open else [],
        interval=_interval(ranked) if is_open and ranked else None,
        answer=shown.revealed.answer if is_open else None,
        on_their_way=len(waiting),
        race=class_race_of(room, card) if card in room.revealed else None,
    )


def _interval(distances_m: Sequence[float]) -> IntervalView:
    interval = iqm_interval((tuple(distances_m),), _SEED_OF_INTERVALS)
    return IntervalView(iqm_m=interval.value, low_m=interval.low, high_m=interval.high)


def _newest(room: Room, store: RunStore, seed: int, card: int) -> _Run | None:
    """Return the newest finished run or what-if of a participant on a card, else the newest.

    Deleted runs are skipped.
    """
    newest: _Run | None = None
    for room_run in room.runs_of(seed, card):
        result = _result(room, room_run, store)
        if result is not None and (
            newest is None or newest.shown.state != "finished" or result.shown.state == "finished"
        ):
            newest = result
    return newest


def _result(room: Room, room_run: RoomRun, store: RunStore) -> _Run | None:
    finished: _Run | None = room.finished.get(room_run.run_id)
    if finished is not None:
        return finished  # a run that has finished changes no more, and a class asks again and again
    if room_run.answer is not None:
        outcome = WalkOutcome(room_run.answer.chosen.iqm_m)
        return _run(room_run, "what-if", "finished", outcome)
    try:
        run = store.find(room_run.run_id)
    except NotFound:
        return None  # deleted, or never stored
    if not isinstance(run, Run):
        return None
    result = _run(room_run, run.kind, run.state, _outcome(run, store))
    if run.state == "finished":
        room.finished[room_run.run_id] = result
    return result


def _run(room_run: RoomRun, kind: str, state: State, outcome: WalkOutcome) -> _Run:
    shown = RunOutcome(
        id=room_run.run_id,
        kind=kind,
        state=state,
        given=dict(room_run.given),
        distance_m=outcome.distance_m,
        winners=list(outcome.winners),
        rank=None,
        answer=room_run.answer,
    )
    return _Run(shown, outcome)


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
