"""Finds by their names which legs are in front, behind, left and right, in several languages."""

import re
import unicodedata
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from hexapods.domain.types import FloatArray

Side = Literal["front", "hind", "left", "right"]
_OPPOSITE: dict[Side, Side] = {"front": "hind", "hind": "front", "left": "right", "right": "left"}


@dataclass(frozen=True)
class _Language:
    """The words of a language for the sides of a robot.

    Attributes:
        words: whole words of each side; two of them may be one word, such as `linksvorne`.
        parts: what else in a name tells a side, also within a word.
    """

    words: Mapping[Side, frozenset[str]]
    parts: Mapping[Side, tuple[str, ...]]


def _language(front: str, hind: str, left: str, right: str) -> _Language:
    texts = zip(get_args(Side), (front, hind, left, right), strict=True)
    return _Language({side: frozenset(text.split()) for side, text in texts}, {})


_ENGLISH = _Language(
    {
        "front": frozenset(["fl", "fr", "lf", "rf"]),
        "hind": frozenset(["hl", "hr", "lh", "rh", "bl", "br", "lb", "rb", "rl", "rr", "lr"]),
        "left": frozenset(["l", "fl", "lf", "hl", "lh", "bl", "lb", "rl", "lr", "ml", "lm"]),
        "right": frozenset(["r", "fr", "rf", "hr", "rh", "br", "rb", "rr", "mr", "rm"]),
    },
    {
        "front": ("front", "fore"),
        "hind": ("hind", "rear", "back"),
        "left": ("left",),
        "right": ("right",),
    },
)
_OTHER_LANGUAGES = (
    _language(  # German
        "vorn vorne vorder vordere vorderer vorderes vorderbein vl vr",
        "hinten hinter hintere hinterer hinteres hinterbein hl hr",
        "links linke linker linkes vl hl ml",
        "rechts rechte rechter rechtes vr hr mr",
    ),
    _language("avant", "arriere", "gauche", "droite droit"),  # French
    _language(  # Spanish
        "delantero delantera delante frontal anterior",
        "trasero trasera detras posterior",
        "izquierdo izquierda izq",
        "derecho derecha der",
    ),
    _language(  # Italian
        "anteriore davanti", "posteriore dietro", "sinistro sinistra sx", "destro destra dx"
    ),
    _language(  # Portuguese
        "dianteiro dianteira frente",
        "traseiro traseira tras",
        "esquerdo esquerda esq",
        "direito direita dir",
    ),
    _language("on", "arka", "sol", "sag"),  # Turkish
    _language("qian", "hou", "zuo", "you"),  # Chinese, in pinyin
)


def sides_by_names(
    mounts: FloatArray, names: Sequence[Sequence[str]]
) -> dict[Side, FloatArray | None]:
    """Return the mean place of the legs of each side, (2,); None for sides of which no name tells.

    It is the first language that has words for two opposite sides. Words of languages other than
    English may be something else, as `on` and `sol`: each of two opposite sides must have as many
    legs, more than one of four and more, and the places must not contradict the names.

    Args:
        mounts: places of the legs' mounts from above, (legs, 2).
        names: names of the joints and bodies of each leg.
    """
    for language in (_ENGLISH, *_OTHER_LANGUAGES):
        legs = {side: _called(names, side, language) for side in get_args(Side)}
        if not (_are_told(legs, "front") or _are_told(legs, "left")):
            continue
        sides = {side: _mean(mounts, of_side) for side, of_side in legs.items()}
        if language is _ENGLISH or (_are_even(legs) and not contradict(sides)):
            return sides
    return dict.fromkeys(get_args(Side))


def contradict(sides: Mapping[Side, FloatArray | None]) -> bool:
    """Whether the left legs are on the right, seen in the direction from hind to front legs."""
    front, hind, left, right = (sides[side] for side in get_args(Side))
    if front is None or hind is None or left is None or right is None:
        return False
    ahead, across = front - hind, left - right
    return float(ahead[0] * across[1] - ahead[1] * across[0]) <= 0


def _are_told(legs: Mapping[Side, Sequence[bool]], side: Side) -> bool:
    return any(legs[side]) and any(legs[_OPPOSITE[side]])


def _are_even(legs: Mapping[Side, Sequence[bool]]) -> bool:
    """Whether opposite sides have as many legs, and several of four and more."""
    least = 1 if len(legs["left"]) < 4 else 2
    pairs: tuple[tuple[Side, Side], ...] = ("front", "hind"), ("left", "right")
    counts = [(sum(legs[side]), sum(legs[other])) for side, other in pairs]  # whole numbers
    return all(count == other >= least for count, other in counts if count or other)


def _mean(mounts: FloatArray, legs: Sequence[bool]) -> FloatArray | None:
    return mounts[np.array(legs)].mean(axis=0) if any(legs) else None


def _called(names: Sequence[Sequence[str]], side: Side, language: _Language) -> list[bool]:
    """Return for each leg whether it is called after a side, and not after the opposite one."""
    other = _OPPOSITE[side]
    return [
        _has_word(of_leg, side, language) and not _has_word(of_leg, other, language)
        for of_leg in names
    ]


def _has_word(names: Iterable[str], side: Side, language: _Language) -> bool:
    words = language.words[side]
    compounds = frozenset().union(*language.words.values()) if language is not _ENGLISH else ()
    for name in names:
        plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
        apart = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", plain).lower()
        words_of_name = {*re.split(r"[^a-z]+", apart)}
        if words & words_of_name or any(part in apart for part in language.parts.get(side, ())):
            return True
        if any(
            word in (first + second, second + first)
            for word in words_of_name
            for first in words
            for second in compounds
        ):
            return True
    return False
