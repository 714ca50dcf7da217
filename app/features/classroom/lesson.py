"""Lessons: a lesson is one document of cards, each with what it shows, asks and lets be changed."""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, Literal, NamedTuple

from annotated_types import Ge, Le, MaxLen, MinLen
from pydantic import Field, TypeAdapter, ValidationError

from app.answer import Answer
from app.features.classroom.card_settings import check_bounds
from app.features.classroom.markdown import (
    Markdown,
    Title,
    as_html,
    check_line,
    check_markdown,
)
from app.features.classroom.page_state import PageState, Tab
from app.features.classroom.questions import (
    MAX_CHOICES,
    Ask,
    KnowledgeQuestion,
    Number,
    check_knowledge,
    check_question,
    check_right,
)
from app.features.classroom.teach import Teach, check_steps
from app.storage.json_text import is_finite
from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.records import Record
from hexapods.domain.settings import MAX_SETTING_NAME
from hexapods.domain.text import MAX_NAME

_GIVEN_REFERENCE = "#/components/schemas/Given{model}"
GIVEN_LESSON: dict[str, Any] = {"$ref": _GIVEN_REFERENCE.format(model="Lesson")}
"""Schema of a lesson as it is sent."""
MAX_CARDS = 60
MAX_AIMS = 12
MAX_MAY = 30
MIN_MINUTES, MAX_MINUTES = 5, 240


class WordsAround(NamedTuple):
    """Texts of the two questions around a lesson, which a room asks where it has one.

    Attributes:
        before: title of the first question.
        once_more: text of the first question where the second is the same.
        after: title of the second question.
        again: text of the second question where it is the first one.
    """

    before: str | None = None
    once_more: str = ""
    after: str | None = None
    again: str = ""


_NO_WORDS = WordsAround()
_AROUND = {
    "en": WordsAround(
        "Before the lesson",
        "Answer alone. The same question comes again at the end of the lesson.",
        "After the lesson",
        "The question of the beginning, once more.",
    ),
    "de": WordsAround(
        "Vor der Lektion",
        "Antworte allein. Dieselbe Frage kommt am Ende der Lektion noch einmal.",
        "Nach der Lektion",
        "Die Frage vom Anfang, noch einmal.",
    ),
    "fr": WordsAround(
        "Avant la leçon",
        "Réponds sans les autres. La même question revient à la fin de la leçon.",
        "Après la leçon",
        "La question du début, encore une fois.",
    ),
}
LANGUAGE = r"^[a-z]{2,3}(-[A-Za-z0-9]{2,8}){0,3}$"
Go = Literal["training", "race", "what-if"]


@dataclass(frozen=True, kw_only=True)
class Bounds(Record):
    """Allowed values of a setting; without any bound, all that are valid.

    Attributes:
        minimum: least number, inclusive.
        maximum: greatest number, inclusive.
        choices: the values of which one may be chosen.
    """

    minimum: Number | None = None
    maximum: Number | None = None
    choices: Annotated[tuple[Number | str | bool, ...], MinLen(1), MaxLen(MAX_CHOICES)] | None = (
        None
    )


@dataclass(frozen=True, kw_only=True)
class Reveal(Record):
    """Text and answer that are revealed after the answers.

    Attributes:
        text: in Markdown.
        answer: the right choice or number, where it does not follow from the runs.
    """

    text: Markdown = ""
    answer: Number | Title | None = None


@dataclass(frozen=True, kw_only=True)
class Card(Record):
    """A page of a lesson.

    Attributes:
        text: in Markdown.
        state: what it opens of the page.
        show: the tabs of the panel that are shown; null for those of the depth.
        may: by name the settings that may be changed, each with its bounds.
        ask: its question.
        go: what the button runs, from the form of the state; null for nothing.
        teach: how the class teaches a robot, which walks by the form of the state.
        reveal: what is revealed afterwards, or its text alone.
    """

    title: Title | None = None
    text: Markdown
    state: PageState | None = None
    show: Annotated[tuple[Tab, ...], MaxLen(7)] | None = None
    may: Annotated[Mapping[str, Bounds], MaxLen(MAX_MAY)] = Field(default_factory=dict)
    ask: Ask | None = None
    go: Go | None = None
    teach: Teach | None = None
    reveal: Reveal | Markdown | None = None

    @property
    def form(self) -> Mapping[str, Any]:
        """Fields of the start that the card offers."""
        return {} if self.state is None or self.state.form is None else self.state.form

    @property
    def revealed(self) -> Reveal:
        """Text and answer that are revealed afterwards."""
        reveal = self.reveal
        return reveal if isinstance(reveal, Reveal) else Reveal(text=reveal or "")


@dataclass(frozen=True, kw_only=True)
class Lesson(Record):
    """A lesson.

    Attributes:
        title: in plain text.
        language: of its texts, such as `en` or `de-AT`.
        minutes: how long it takes a class; null where its author does not say.
        ages: for whom it is, such as "from 12".
        aims: what is learned, each a line of plain text.
        before: question that a room asks before the first card, to measure what the class gains.
        after: question that it asks after the last card; by default that of `before` again.
        cards: its pages, in order.
    """

    title: Title
    language: Annotated[str, MaxLen(40), Field(pattern=LANGUAGE)] = "en"
    minutes: Annotated[int, Ge(MIN_MINUTES), Le(MAX_MINUTES)] | None = None
    ages: Title | None = None
    aims: Annotated[tuple[Title, ...], MaxLen(MAX_AIMS)] = ()
    before: KnowledgeQuestion | None = None
    after: KnowledgeQuestion | None = None
    cards: Annotated[tuple[Card, ...], MinLen(1), MaxLen(MAX_CARDS)]

    @property
    def deck(self) -> tuple[Card, ...]:
        """The cards as a room shows them, between the questions before and after the lesson."""
        if self.before is None:
            return self.cards
        words = _AROUND.get(self.language.partition("-")[0], _NO_WORDS)
        first, last = self.before, self.after or self.before
        return (
            Card(
                title=words.before,
                text=words.once_more if self.after is None else "",
                may={},
                ask=first.ask,
            ),
            *self.cards,
            Card(
                title=words.after,
                text=words.again if self.after is None else "",
                may={},
                ask=last.ask,
                reveal=Reveal(answer=last.right),
            ),
        )


LAST_CARD = MAX_CARDS + 1
"""Number of the last card that a room may have, from 0: two questions are around the lesson."""
CardNumber = Annotated[int, Field(ge=0, le=LAST_CARD)]
_RECORDS: Mapping[str, type[Any]] = {
    "state": PageState,
    "ask": Ask,
    "teach": Teach,
    "before": KnowledgeQuestion,
    "after": KnowledgeQuestion,
    "reveal": Reveal,
    "Reveal": Reveal,
}
"""Records by the field that has one."""


@cache
def adapter() -> TypeAdapter[Lesson]:
    """Return Pydantic's adapter of lessons."""
    return TypeAdapter(Lesson)


def add_given_schemas(schemas: dict[str, Any]) -> None:
    """Add the schemas of lessons as they are sent, in which more may be left out than in answers.

    Args:
        schemas: those of the description of the API, by name.
    """
    schema = adapter().json_schema(ref_template=_GIVEN_REFERENCE)
    definitions = schema.pop("$defs") | {"Lesson": schema}
    schemas |= {f"Given{name}": definition for name, definition in definitions.items()}


def read_lesson(data: Any) -> Lesson:
    """Read a lesson from plain values, as they come from JSON or YAML.

    Raises:
        InvalidInput: naming the field, and what is valid: for unknown fields, values of another
            type or size, HTML in a text, and bounds outside of the setting's.
    """
    try:
        if not is_finite(data):
            raise InvalidInput("a lesson has no NaN and no infinite numbers; give finite ones")
        # As JSON, where strict types have lists for tuples.
        lesson = adapter().validate_json(json.dumps(data), strict=True)
    except (TypeError, RecursionError):
        raise InvalidInput("a lesson is plain values: texts, numbers, lists, objects") from None
    except ValidationError as error:
        raise InvalidInput(_sentence(error)) from None
    check_line("title", lesson.title)
    for number, aim in enumerate(lesson.aims):
        check_line(f"aims.{number}", aim)
    if lesson.ages is not None:
        check_line("ages", lesson.ages)
    if lesson.before is None and lesson.after is not None:
        raise InvalidInput("after is compared with before; give before, too")
    for name, question in (("before", lesson.before), ("after", lesson.after)):
        if question is not None:
            check_knowledge(question, name)
    for number, card in enumerate(lesson.cards):
        _check_card(card, f"cards.{number}")
    return lesson


def plain(lesson: Lesson) -> dict[str, Any]:
    """Return a lesson as plain values without what is null or empty, as a person would write it."""
    whole = adapter().dump_python(lesson, mode="json")
    document: dict[str, Any] = _without_nothing(whole)
    for card, short in zip(whole["cards"], document["cards"], strict=True):
        if card["may"]:
            # The bounds of a setting may be empty: all that is valid.
            short["may"] = {name: _without_nothing(bounds) for name, bounds in card["may"].items()}
    return document


class CardTexts(Answer):
    """The texts of a card as HTML: of the card, of its question, and of what is revealed."""

    text: str
    ask: str
    reveal: str


def html_of(card: Card) -> CardTexts:
    """Return the texts of a card as HTML that a page may show as it is."""
    return CardTexts(
        text=as_html(card.text),
        ask="" if card.ask is None else as_html(card.ask.text),
        reveal=as_html(card.revealed.text),
    )


def _without_nothing(value: Any) -> Any:
    if isinstance(value, dict):
        fields_ = {name: _without_nothing(item) for name, item in value.items() if item is not None}
        return {name: item for name, item in fields_.items() if item not in ([], {})}
    return [_without_nothing(item) for item in value] if isinstance(value, list) else value


def _check_card(card: Card, where: str) -> None:
    if card.title is not None:
        check_line(f"{where}.title", card.title)
    check_markdown(card.text, f"{where}.text")
    check_markdown(card.revealed.text, f"{where}.reveal")
    if card.ask is not None:
        check_question(card.ask, f"{where}.ask")
    for name, bounds in card.may.items():
        try:
            check_bounds(name, bounds, card.form)
        except InvalidInput as error:
            raise InvalidInput(f"{where}.may.{name[:MAX_SETTING_NAME]}: {error}") from error
    if card.teach is not None and card.go is not None:
        raise InvalidInput(f"{where}.teach: a card either runs something or teaches; leave out go")
    if card.teach is not None:
        check_steps(card.teach, f"{where}.teach")
    if card.ask is not None and card.revealed.answer is not None:
        check_right(card.ask, card.revealed.answer, f"{where}.reveal")


def _sentence(error: ValidationError) -> str:
    first = error.errors(include_url=False, include_input=False, include_context=False)[0]
    path, message = first["loc"], first["msg"]
    if first["type"] == "unexpected_keyword_argument":
        where = ".".join(map(str, path[:-1]))
        unknown = UnknownName("field", str(path[-1])[:MAX_NAME], _fields_at(path[:-1]))
        return f"{where}: {unknown}" if where else str(unknown)
    where = ".".join(str(key) for key in path if re.fullmatch(r"[\w.-]{1,60}", str(key)))
    if not where:
        return "a lesson is an object with title and cards"
    message = message.replace("Input should be", "must be").replace("Value should have", "has")
    if first["type"] == "missing":
        return f"{where} is missing"
    if first["type"] == "string_pattern_mismatch":
        return f"{where} must be the code of a language, such as en or de-AT"
    return f"{where}: {message[0].lower()}{message[1:]}"


def _fields_at(path: tuple[int | str, ...]) -> list[str]:
    """Return the names of the fields of the record at a path."""
    last = path[-1] if path else ""
    if isinstance(last, int):
        record: type[Any] = Card
    elif len(path) >= 2 and path[-2] == "may":
        record = Bounds
    else:
        record = _RECORDS.get(last, Lesson)
    return list(record.__dataclass_fields__)
