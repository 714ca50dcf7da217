"""A room: a class that goes through a lesson together, with checks of participants' actions."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from typing import Any, Literal

from app.answer import Answer, Count
from app.features.classroom.lesson import Card, Lesson
from app.features.classroom.room_rows import ParticipantRow, RoomRun
from app.storage.errors import Conflict, Forbidden, NotFound

Phase = Literal["open", "frozen", "ended"]
CardAction = Literal["predict", "run", "press"]
"""Actions of a participant that the card may allow."""
_ASKS_NOTHING = "card {number} asks nothing; wait for one with a question"
_TEACHES_NOTHING = "card {number} teaches nothing; wait for one on which the class teaches"
_RUNS_NOTHING = "card {number} runs nothing; wait for one with a button to go"


class RoomState(Answer):
    """State of a room that all in it may know.

    Attributes:
        state: `open`, `frozen`: nothing can be answered or started, or `ended`.
        card: number of the card that is shown, from 0.
        cards: number of the lesson's cards.
        revealed: numbers of the cards that are revealed.
        participants: number of participants who are in the room.
        predicted: number of participants who have answered the card that is shown.
        started: number of participants who have started a run on it.
        knowledge: whether the card asks what is known before the lesson, or after it; null for
            cards of the lesson.
        spotlight: id of the run on its stage.
    """

    code: str
    title: str
    language: str
    lesson_id: str | None
    state: Phase
    card: Count
    cards: Count
    revealed: list[Count]
    participants: Count
    predicted: Count
    started: Count
    knowledge: Literal["before", "after"] | None
    spotlight: str | None
    needs_approval: bool


class RoomEvent(RoomState):
    """A room has changed; sent on its own stage alone."""


@dataclass
class Room:
    """A room, as it is in the database.

    Attributes:
        code: code by which participants join.
        lesson_id: id of the lesson that was chosen; None for none.
        lesson: the lesson that is taught.
        card: number of the card that is shown, from 0.
        revealed: numbers of the cards that are revealed.
        is_frozen: whether nothing can be answered or started.
        needs_approval: whether others see of a participant only what was approved.
        spotlight: id of the run on the room's stage; None for none.
        created_at, ended_at: times in UTC; the room is open while `ended_at` is None.
        participants: participants by seed, with those who left after an answer or a start.
        predictions: answers by seed and card.
        runs: runs and what-ifs by id, oldest first.
        next_seed: seed of the next participant; no seed is given twice.
        used_at: time of the last action in the room, as far as it is known, in UTC.
        finished: cache of the outcomes of finished runs, by id; `results` fills it.
        watched: ids of the runs that their participants have seen to the end, since the start of
            the server.
        pressed: what the class pressed by step, by id of a training that it taught, since the start
            of the server: the training's record has the means alone.
    """

    code: str
    lesson_id: str | None
    lesson: Lesson
    card: int
    revealed: frozenset[int]
    is_frozen: bool
    needs_approval: bool
    spotlight: str | None
    created_at: datetime
    ended_at: datetime | None
    participants: dict[int, ParticipantRow] = field(default_factory=dict)
    predictions: dict[tuple[int, int], Any] = field(default_factory=dict)
    runs: dict[str, RoomRun] = field(default_factory=dict)
    next_seed: int = field(default=0, compare=False)
    used_at: datetime = field(default=datetime.min.replace(tzinfo=UTC), compare=False)
    finished: dict[str, Any] = field(default_factory=dict, compare=False, repr=False)
    watched: set[str] = field(default_factory=set, compare=False, repr=False)
    pressed: dict[str, list[Any]] = field(default_factory=dict, compare=False, repr=False)

    @property
    def is_open(self) -> bool:
        """Whether the room has not ended."""
        return self.ended_at is None

    @property
    def shown(self) -> Card:
        """The card that is shown."""
        return self.deck[self.card]

    @property
    def deck(self) -> tuple[Card, ...]:
        """The cards that the room shows, see `Lesson.deck`."""
        return self.lesson.deck

    @property
    def knowledge_cards(self) -> tuple[int, int] | None:
        """Numbers of the cards that ask before the lesson and after it; None without them."""
        return None if self.lesson.before is None else (0, len(self.deck) - 1)

    @property
    def present(self) -> list[ParticipantRow]:
        """The participants who have not left, by seed."""
        # Copied first, as others may join meanwhile.
        return [
            participant
            for _, participant in sorted({**self.participants}.items())
            if participant.left_at is None
        ]

    @property
    def phase(self) -> Phase:
        """Phase of the room: open, frozen or ended."""
        if not self.is_open:
            return "ended"
        return "frozen" if self.is_frozen else "open"

    @property
    def state(self) -> RoomEvent:
        """Data of the `room` event: the state that all in the room may know."""
        runs = list(self.runs.values())
        started = {run.seed for run in runs if run.is_main and run.card == self.card}
        return RoomEvent(
            code=self.code,
            title=self.lesson.title,
            language=self.lesson.language,
            lesson_id=self.lesson_id,
            state=self.phase,
            card=self.card,
            cards=len(self.deck),
            revealed=sorted(self.revealed),
            participants=len(self.present),
            predicted=sum(card == self.card for _, card in list(self.predictions)),
            started=len(started),
            knowledge=self.knowledge_of(self.card),
            spotlight=self.spotlight,
            needs_approval=self.needs_approval,
        )

    def snapshot(self) -> "Room":
        """Return a copy whose participants, predictions and runs do not change meanwhile."""
        return replace(
            self,
            participants={**self.participants},
            predictions={**self.predictions},
            runs={**self.runs},
        )

    def refusal(self, action: CardAction) -> str | None:
        """Return why the card that is shown forbids an action; None if it allows it."""
        card = self.shown
        if action == "predict" and card.ask is None:
            return _ASKS_NOTHING.format(number=self.card)
        if action == "run" and card.go is None:
            return _RUNS_NOTHING.format(number=self.card)
        if action == "press" and card.teach is None:
            return _TEACHES_NOTHING.format(number=self.card)
        return None

    def check_open(self) -> None:
        """Check that the room has not ended.

        Raises:
            Conflict: if it has.
        """
        if not self.is_open:
            raise Conflict(
                f"the room {self.code} has ended; ask for the code of a new one", "ended"
            )

    def check_going_on(self) -> None:
        """Check that the room has neither ended nor is frozen.

        Raises:
            Conflict: if it is either.
        """
        self.check_open()
        if self.is_frozen:
            raise Conflict("the teacher has stopped the class for a moment; wait", "frozen")

    def check_card(self, number: int) -> None:
        """Check that the lesson has a card.

        Raises:
            NotFound: if it has not.
        """
        last = len(self.deck) - 1
        if not 0 <= number <= last:
            raise NotFound(f"the lesson has no card {number}; its cards are 0 to {last}")

    def knowledge_of(self, number: int) -> Literal["before", "after"] | None:
        """Return whether a card asks what is known before the lesson, or after it."""
        before, after = self.knowledge_cards or (None, None)
        return "before" if number == before else "after" if number == after else None

    def revealed_with(self, number: int) -> frozenset[int]:
        """Return the numbers of the cards that are revealed together with a card.

        Raises:
            Conflict: if it asks before the lesson: what is right would be known after it.
        """
        match self.knowledge_of(number), self.knowledge_cards:
            case "before", (_, after):
                raise Conflict(
                    f"card {number} asks before the lesson; it is revealed with card {after}, "
                    "which asks after it",
                    "open",
                )
            case "after", (before, _):
                return frozenset({before, number})
        return frozenset({number})

    def check_seated(self, seed: int) -> None:
        """Check that a participant has a seat: was not removed, and has not left.

        Raises:
            Forbidden: if not.
        """
        if seed not in self.participants or self.participants[seed].left_at is not None:
            raise Forbidden(f"you are not in the room {self.code} any more; join it again")

    def has_acted(self, seed: int) -> bool:
        """Whether a participant has answered or started anything, on any card."""
        answered = any(participant_seed == seed for participant_seed, _ in list(self.predictions))
        return answered or any(run.seed == seed for run in list(self.runs.values()))

    def participant(self, seed: int) -> ParticipantRow:
        """Return the participant with a seed.

        Raises:
            NotFound: if there is none.
        """
        if seed not in self.participants:
            raise NotFound(f"the room {self.code} has no participant with the seed {seed}")
        return self.participants[seed]

    def runs_of(self, seed: int, card: int) -> list[RoomRun]:
        """Return the runs and what-ifs that a participant started on a card, oldest first."""
        return [
            run
            for run in list(self.runs.values())
            if run.is_main and (run.seed, run.card) == (seed, card)
        ]

    def has_shown(self, card: int) -> bool:
        """Whether a card is shown, is before the one that is, or is revealed."""
        return card <= self.card or card in self.revealed

    def shows(self, seed: int, card: int) -> bool:
        """Whether others see the answer and the runs of a participant on a card."""
        return card in self.revealed and self.participants[seed].is_approved

    def name_for_others(self, seed: int) -> str | None:
        """Return the name of a participant as others see it; None if it is hidden."""
        participant = self.participants[seed]
        return (
            None if participant.is_name_hidden or not participant.is_approved else participant.name
        )


def given_key(given: Mapping[str, Any]) -> tuple[tuple[str, str], ...]:
    """Return a hashable key of settings: equal settings have equal keys."""
    return tuple(sorted((name, repr(value)) for name, value in given.items()))
