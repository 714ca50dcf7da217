"""Response models of lessons and rooms, as those of `app.api.answers`."""

from dataclasses import dataclass
from datetime import datetime
from typing import Literal

from pydantic import JsonValue

from app.answer import Answer, Count
from app.features.classroom.lesson import Card, CardTexts, Lesson
from app.features.classroom.room import Phase, RoomState
from app.storage.run import State


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
        minutes: how long it takes a class, if its author says so.
        ages: for whom it is.
        has_knowledge_question: whether a question is asked before it and after it.
        cards: number of its cards.
    """

    id: str
    title: str
    language: str
    minutes: Count | None
    ages: str | None
    aims: list[str]
    has_knowledge_question: bool
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
    state: Phase
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
