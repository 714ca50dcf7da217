"""State of presenters' windows beside the stage: the card that is shown, and how."""

from dataclasses import dataclass
from typing import Annotated, Literal

from annotated_types import Ge, Le
from pydantic import Field

from app.api.descriptions import VALID
from hexapods.domain.records import Record

MAX_CARDS = 99
VALID.update(
    {
        "presentation": "an object with any of card, shows_why, is_blank and code",
        "presentation.card": f"the number of a card, from 1 to {MAX_CARDS}, or null",
        "shows_why": "true or false",
        "is_blank": "true or false",
        "code": "large, small or none",
    }
)
VALID.setdefault("card", VALID["presentation.card"])


@dataclass(frozen=True, kw_only=True)
class Presentation(Record):
    """State of presenters' windows beside the stage; set by their keys or by a remote."""

    card: Annotated[
        Annotated[int, Ge(1), Le(MAX_CARDS)] | None,
        Field(description="number of the card that is shown, from 1; null before the first"),
    ] = None
    shows_why: Annotated[
        bool, Field(strict=True, description="whether the step that is shown is explained")
    ] = False
    is_blank: Annotated[bool, Field(strict=True, description="whether they show nothing")] = False
    code: Annotated[
        Literal["large", "small", "none"],
        Field(description="size of the QR code of the spectators' address"),
    ] = "large"
