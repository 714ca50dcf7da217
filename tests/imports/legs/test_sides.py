"""Forward and the sides of legs, by names in several languages and by the places of the legs."""

import math
from collections.abc import Mapping

import numpy as np
import pytest

from hexapods.imports.choices import AS_FOUND, Choices
from hexapods.imports.legs.directions import find_forward
from hexapods.imports.legs.sides import sides_by_names
from hexapods.imports.notes import Note, Notes

Places = Mapping[str, tuple[float, float]]


def forward(legs: Places) -> tuple[float, Note]:
    """Return forward of a robot whose legs have such names and places, and the guess."""
    notes = Notes()
    names = [[f"{name}_joint1", f"{name}_bein", f"{name}Fuss"] for name in legs]
    angle = find_forward(np.array(list(legs.values())), names, "z", AS_FOUND, notes)
    (note,) = notes.collected()
    return angle, note


@pytest.mark.parametrize(
    "words",
    [
        "vorne hinten links rechts",
        "VORDERE Hintere linke rechte",
        "avant arrière gauche droite",
        "delantero trasero izquierdo derecho",
        "delantera trasera izquierda derecha",
        "anteriore posteriore sinistra destra",
        "dianteiro traseiro esquerdo direito",
        "ön arka sol sağ",
        "on arka sol sag",
        "qian hou zuo you",
    ],
)
@pytest.mark.parametrize("pattern", ["bein_{0}_{1}", "{1}-{0}", "bein{0}{1}", "leg3 {1}{0}4"])
def test_legs_have_names_in_other_languages(words: str, pattern: str) -> None:
    front, hind, left, right = words.split()
    legs = {
        pattern.format(*(word.title() if "bein{" in pattern else word for word in pair)): place
        for pair, place in {
            (front, left): (-0.1, -0.3),
            (front, right): (0.1, -0.3),
            (hind, left): (-0.1, 0.3),
            (hind, right): (0.1, 0.3),
        }.items()
    }
    # Left is right in these places, so that names would contradict them: mirrored they do not.
    mirrored = {name: (-x, y) for name, (x, y) in legs.items()}

    assert forward(mirrored) == (-90.0, forward(mirrored)[1])
    assert "by the names of the legs in front and behind" in forward(mirrored)[1].text
    assert forward(legs)[0] == 0
    assert "no name tells" in forward(legs)[1].text


def test_two_sides_are_enough() -> None:
    legs = {"sol_1": (0.1, 0.2), "sol_2": (0.1, -0.2), "sag_1": (-0.1, 0.2), "sag_2": (-0.1, -0.2)}

    angle, note = forward(legs)

    assert angle == -90
    assert "by the names of the legs left and right" in note.text


@pytest.mark.parametrize(
    "names",
    [
        ("on_1", "leg_2", "leg_3", "arka_4"),  # one leg of four
        ("sol_1", "sol_2", "leg_3", "leg_4"),  # nothing is called right
        ("sol_1", "sol_2", "sol_3", "sag_4"),
        ("avantgarde_1", "avantgarde_2", "arrierefond_3", "arrierefond_4"),  # no whole words
    ],
)
def test_words_that_may_be_anything_else_tell_nothing(names: tuple[str, ...]) -> None:
    places = np.array([(0.1, 0.2), (0.1, -0.2), (-0.1, 0.2), (-0.1, -0.2)])

    assert set(sides_by_names(places, [[name] for name in names]).values()) == {None}


def columns(angle_deg: float, bulge: float = 0.0) -> Places:
    """Return legs in two columns along an angle from x, whose middle legs are farther out."""
    turn = math.radians(angle_deg)
    return {
        f"leg{3 * side + row}": (
            math.cos(turn) * along - math.sin(turn) * across,
            math.sin(turn) * along + math.cos(turn) * across,
        )
        for side, sign in enumerate((1, -1))
        for row, along in enumerate((0.2, 0.0, -0.2))
        for across in (sign * (0.1 + (bulge if row == 1 else 0.0)),)
    }


@pytest.mark.parametrize("bulge", [0.0, 0.05])
def test_a_robot_walks_along_its_columns_of_legs(bulge: float) -> None:
    angle, note = forward(columns(90, bulge))

    assert angle == 90
    assert "forward is y of the file's frame, along the two columns of legs" in note.text
    assert note.offer == Choices(forward="-y")
    assert forward(columns(0, bulge))[0] == 0


@pytest.mark.parametrize("first_deg", [0, 30])
def test_legs_that_are_evenly_spaced_walk_along_x(first_deg: float) -> None:
    turns = [math.radians(first_deg + 60 * leg) for leg in range(6)]

    angle, note = forward({f"leg{n}": (math.cos(t), math.sin(t)) for n, t in enumerate(turns)})

    assert angle == 0
    assert note.offer == Choices(forward="-x")


def test_names_that_contradict_places_are_offered() -> None:
    legs = {"FL": (-0.1, 0.2), "FR": (-0.1, -0.2), "RL": (0.1, 0.2), "RR": (0.1, -0.2)}

    angle, note = forward(legs)

    assert angle == 0
    assert "contradict their places" in note.text
    assert note.offer == Choices(forward="-x")
