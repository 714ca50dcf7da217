"""Request bodies of rooms."""

from typing import Annotated

from pydantic import Field, JsonValue

from app.api.descriptions import VALID
from app.api.fields import INTEGRAL, Body
from app.features.classroom.lesson import LAST_CARD, CardNumber
from hexapods.domain.settings import MAX_SETTING_NAME

MAX_SETTINGS = 60

VALID.update(
    {
        "lesson": "the id of a lesson, or a lesson itself",
        "card": f"the number of a card, from 0 to {LAST_CARD}",
        "value": "an answer to the card's question",
        "needs_approval": "true or false",
        "frozen": "true or false",
        "is_name_hidden": "true or false",
        "is_approved": "true or false",
    }
)


class RoomBody(Body):
    """A room: its lesson, by its id or itself, and whether participants have to be approved.

    A built-in lesson can be had in a language, such as `de`; others have one.
    """

    lesson: str | dict[str, JsonValue] | None = None
    language: Annotated[str, Field(max_length=40)] = "en"
    needs_approval: Annotated[bool, Field(strict=True)] = False


class JoinBody(Body):
    """Nothing: a participant's name is from a list of words."""


class CardBody(Body):
    """A card, by its number, from 0."""

    card: Annotated[CardNumber, Field(strict=True), INTEGRAL]


class RevealBody(Body):
    """The card that is revealed; by default the one that is shown."""

    card: Annotated[CardNumber, Field(strict=True), INTEGRAL] | None = None


class FreezeBody(Body):
    """Whether all stands still."""

    frozen: Annotated[bool, Field(strict=True)] = True


class PredictionBody(CardBody):
    """An answer to the question of the card that is shown.

    What an answer is, the kind of the question says.
    """

    value: JsonValue


class RunBody(Body):
    """The settings that the card opens, by name; those that are left out are the card's.

    With `card` it is refused unless that is the card that is shown.
    """

    card: Annotated[CardNumber, Field(strict=True), INTEGRAL] | None = None
    settings: Annotated[
        dict[Annotated[str, Field(max_length=MAX_SETTING_NAME)], JsonValue],
        Field(max_length=MAX_SETTINGS),
    ] = Field(default_factory=dict)


class SpotlightBody(Body):
    """The run of the room that its stage shows; null for none."""

    run_id: Annotated[str, Field(max_length=64)] | None


class ParticipantBody(Body):
    """Changes of how others see a participant; a field that is left out stays as it is."""

    is_name_hidden: Annotated[bool, Field(strict=True)] | None = None
    is_approved: Annotated[bool, Field(strict=True)] | None = None
