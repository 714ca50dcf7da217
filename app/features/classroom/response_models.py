"""Response models of lessons and rooms, as those of `app.api.answers`."""

from dataclasses import dataclass
from datetime import datetime
from typing import Annotated, Any, Literal

from pydantic import Field, JsonValue

from app.api.answers import Answer, ComparisonView, Count
from app.api.run_views import KindName
from app.features.classroom.lesson import Card, Lesson
from app.features.classroom.questions import Ask, Score
from app.storage.run import State


class CardTexts(Answer):
    """The texts of a card as HTML: of the card, of its question, and of what is revealed."""

    text: str
    ask: str
    reveal: str


@dataclass(frozen=True, kw_only=True)
class LessonView(Lesson):
    """A lesson with its id.

    Attributes:
        id: of the lesson.
        is_built_in: whether it comes with the server.
        is_taught: whether an open room teaches it and who asks is no operator, so that what is
            revealed and the cards after the one that is shown are left out.
        html: the texts of each card as HTML that a page may show as it is.
    """

    id: str
    is_built_in: bool
    is_taught: bool
    html: tuple[CardTexts, ...]


class ListedLesson(Answer):
    """A lesson in a list.

    Attributes:
        cards: number of its cards.
    """

    id: str
    title: str
    language: str
    aims: list[str]
    cards: Count
    is_built_in: bool


class LessonList(Answer):
    """All lessons: the built-in ones, then those that were stored, newest first."""

    items: list[ListedLesson]


class NewLesson(Answer):
    """A lesson that was stored.

    Attributes:
        link: address of the page with it, for others if they can reach the server.
        qr_code: of the link, an SVG image as a data URI; null if others cannot reach the server.
    """

    id: str
    link: str
    qr_code: str | None


class NewRoom(Answer):
    """A room that was opened.

    Attributes:
        address: of its page, for others if they can reach the server.
        qr_code: of the address, an SVG image as a data URI; null if phones cannot reach the server.
    """

    code: str
    address: str
    qr_code: str | None


class RoomState(Answer):
    """State of a room that all in it may know.

    Attributes:
        state: `open`, `frozen`: nothing can be answered or started, or `ended`.
        card: number of the card that is shown, from 0.
        cards: number of the lesson's cards.
        revealed: numbers of the cards that are revealed.
        participants: number of those who are in it.
        predicted: number of those who have answered the card that is shown.
        started: number of those who have started a run on it.
        spotlight: id of the run on its stage.
    """

    code: str
    title: str
    language: str
    lesson_id: str | None
    state: Literal["open", "frozen", "ended"]
    card: Count
    cards: Count
    revealed: list[Count]
    participants: Count
    predicted: Count
    started: Count
    spotlight: str | None
    needs_approval: bool


class RoomEvent(RoomState):
    """A room has changed; sent on its own stage alone."""


class OwnRun(Answer):
    """A run that a participant has started, and the card on which that was."""

    run_id: str
    card: Count


class OwnAnswer(Answer):
    """Answer of a participant to the question of a card."""

    card: Count
    value: JsonValue


class Me(Answer):
    """The participant who asks."""

    name: str
    seed: Count
    predictions: list[OwnAnswer]
    runs: list[OwnRun]


class Person(Answer):
    """A participant, as the teacher sees them.

    Attributes:
        is_present: whether they have not left.
        has_predicted: whether they have answered the card that is shown.
        run_id, run_state: of what they started last on the card that is shown.
    """

    seed: Count
    name: str
    is_present: bool
    is_name_hidden: bool
    is_approved: bool
    joined_at: datetime
    has_predicted: bool
    run_id: str | None
    run_state: State | None


class RoomTournament(Answer):
    """A tournament of a room."""

    id: str
    title: str
    state: Literal["open", "ending", "ended"]


class RoomView(RoomState):
    """A room.

    Attributes:
        role: of who asks.
        shown: the card that is shown; what it reveals only after that, or for a teacher.
        html: its texts as HTML.
        me: the participant who asks; null for others.
        people: all participants, for a teacher alone.
        lesson: all of it, for a teacher alone.
        tournaments: of the room, oldest first.
        address: of its page, for others if they can reach the server.
        qr_code: of the address, an SVG image as a data URI; null if phones cannot reach the server.
    """

    role: Literal["teacher", "participant", "spectator"]
    shown: Card
    html: CardTexts
    me: Me | None
    people: list[Person]
    lesson: LessonView | None
    tournaments: list[RoomTournament]
    address: str
    qr_code: str | None


class ListedRoom(Answer):
    """A room in a list."""

    code: str
    title: str
    state: Literal["open", "frozen", "ended"]
    participants: Count
    created_at: datetime


class RoomList(Answer):
    """The rooms that who asks may know: for a teacher all, for a participant their own.

    Attributes:
        is_reachable: whether phones can reach the server, so that a room can be opened for a class.
    """

    items: list[ListedRoom]
    is_reachable: bool


class JoinedView(Answer):
    """A participant who has joined: name, and the seed of all their runs."""

    name: str
    seed: Count


class PredictionView(Answer):
    """An answer that is kept."""

    card: Count
    value: JsonValue


class RunOutcome(Answer):
    """A participant's run on a card.

    Attributes:
        id: of the run; of a what-if that of its record.
        given: settings that they gave, by name.
        distance_m: how far the robot walked; of a race the learner, at time-out; of a what-if the
            interquartile mean with the chosen settings.
        winners: agents of the lanes that won a race.
        rank: among the seeds, 1 for the longest distance; null before the reveal.
        answer: of one's own what-if.
    """

    id: str
    kind: KindName | Literal["what-if"]
    state: State
    given: dict[str, Any]
    distance_m: float | None
    winners: list[str]
    rank: Annotated[int, Field(ge=1)] | None
    answer: ComparisonView | None


class ResultEntry(Answer):
    """A participant's part of a card's results.

    Attributes:
        name: null where it is not to be seen.
        score: of the prediction; for participants after the reveal.
    """

    seed: Count
    name: str | None
    is_own: bool
    prediction: JsonValue
    score: Score | None
    run: RunOutcome | None


class IntervalView(Answer):
    """Interquartile mean of the distances [m] with its 95 % interval, from three seeds on."""

    iqm_m: float
    low_m: float | None
    high_m: float | None


class CardResultsView(Answer):
    """The results of a card, as who asks may see them.

    Attributes:
        participants, predicted, finished: number of participants, of those who have answered, and
            of those whose run has finished.
        entries: before the reveal a participant's own alone.
        distances_m: of all seeds, shortest first; empty before the reveal but for a teacher.
        answer: what the lesson gives as the answer.
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


class ResultsView(Answer):
    """The results of a room, by card."""

    code: str
    cards: list[CardResultsView]
