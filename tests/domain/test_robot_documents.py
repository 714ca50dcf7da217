"""Stored robots: documents by content hash, and robots that are read from them by id."""

import pickle
import re
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest

from hexapods.domain import robot_documents
from hexapods.domain.creatures import CREATURES, PRESETS, own_gait
from hexapods.domain.errors import DamagedFile, InvalidInput
from hexapods.domain.robot import (
    Robot,
    as_mapping,
    by_value,
    document_of,
    read_document,
    robot,
)
from hexapods.domain.robot_library import LIBRARY, About
from hexapods.domain.tolerance import build_tolerance
from hexapods.runs.seeding import BUILDING, generator

BODY = {"preset": "dog", "femur_m": 0.09, "body_height_m": 0.1}


ID = robot_documents.id_of(document_of(robot(BODY)))


@pytest.fixture
def stored() -> Iterator[Robot]:
    """A stored robot, forgotten after the test."""
    yield read_document(document_of(robot(BODY)), "Rex")
    LIBRARY.forget([ID])


@pytest.mark.parametrize("name", CREATURES)
def test_a_document_holds_the_robot_to_the_last_bit(name: str) -> None:
    data = document_of(PRESETS[name])
    loaded = read_document(data)
    assert loaded == PRESETS[name]
    assert loaded.id == robot_documents.id_of(data) == robot_documents.id_of(document_of(loaded))
    LIBRARY.forget([robot_documents.id_of(data)])


def test_the_id_follows_from_the_content_alone(stored: Robot) -> None:
    same = replace(robot(BODY), name="another")
    assert robot_documents.id_of(document_of(same)) == ID
    other = robot({**BODY, "femur_m": 0.0901})
    assert robot_documents.id_of(document_of(other)) != ID


def test_it_is_written_by_its_id_and_its_name(stored: Robot) -> None:
    assert as_mapping(stored) == {"id": ID, "name": "Rex"}
    assert robot({"id": ID}) == stored
    changed = robot({"id": ID, "friction": 0.5})
    assert changed.name == f"robot {ID[:6]} (modified)"
    LIBRARY.describe(ID, About("Rex"))
    changed = robot({"id": ID, "friction": 0.5})
    assert changed.name == "Rex (modified)"
    assert as_mapping(changed) == {"id": ID, "name": "Rex", "friction": 0.5}
    assert robot(as_mapping(changed)) == changed != stored


def test_legs_of_a_stored_robot_are_overridden(stored: Robot) -> None:
    changed = robot({"id": ID, "n_legs": 5})
    assert len(changed.legs) == 5
    assert robot(as_mapping(changed)) == changed
    built = build_tolerance(stored, 0.03, generator(1, BUILDING))
    assert robot(as_mapping(built)) == built != stored


def test_a_name_that_was_given_elsewhere_is_used_unless_it_has_one_here(stored: Robot) -> None:
    assert robot({"id": ID, "name": "Old"}).name == "Old"
    LIBRARY.describe(ID, About("New"))
    assert robot({"id": ID, "name": "Old"}).name == "New"
    assert robot({"id": ID, "name": "Old"}) == stored


@pytest.mark.parametrize(
    ("written", "reason"),
    [
        ({"id": "0" * 16, "name": "Rex"}, "no stored robot '0000000000000000' (Rex); import its"),
        ({"id": "xyz"}, "16 hexadecimal digits"),
        ({"id": 5}, "16 hexadecimal digits"),
        ({"id": "0" * 16, "preset": "dog"}, "not both"),
        ({"id": "0" * 16, "name": 5}, "name must be a text"),
        ({"id": "../../../../etc"}, "16 hexadecimal digits"),
    ],
)
def test_what_is_no_stored_robot_is_refused(written: dict[str, Any], reason: str) -> None:
    with pytest.raises(InvalidInput, match=re.escape(reason)):
        robot(written)


@pytest.mark.parametrize(
    "change",
    [
        lambda data: data[:-1],
        lambda data: data + b" ",
        lambda data: data.replace(b"hexapods-robot-1", b"hexapods-robot-9"),
        lambda data: data.replace(b'"femur_m":0.09', b'"femur_m":NaN'),
        lambda data: data.replace(b'"femur_m":0.09', b'"femur_mm":0.09'),
        lambda data: data.replace(b'"femur_m":0.09', b'"femur_m":0.090'),
        lambda data: data.replace(b'"femur_m":0.09', b'"id":0.09'),
        lambda _: b"[" * 100_000,
        lambda _: b"[" + b"[]," * 100_000 + b"[]]",
        lambda _: b"{}",
        lambda _: b"\xff",
    ],
)
def test_a_document_that_was_changed_is_refused(change: Any) -> None:
    with pytest.raises((DamagedFile, InvalidInput)):
        read_document(change(document_of(robot(BODY))))


def test_a_robot_out_of_its_limits_is_refused() -> None:
    data = document_of(robot(BODY)).replace(b'"femur_m":0.09', b'"femur_m":9.0')
    with pytest.raises(InvalidInput, match="femur_m must be from"):
        read_document(data)


def test_a_robot_is_written_and_pickled_where_its_document_is_not_known_any_more() -> None:
    loaded = read_document(document_of(robot(BODY)), "Rex")
    changed = robot({"id": ID, "name": "Rex", "friction": 0.5})
    LIBRARY.forget([ID])
    assert as_mapping(loaded) == {"id": ID, "name": "Rex"}
    assert as_mapping(changed) == {"id": ID, "name": "Rex", "friction": 0.5}
    assert pickle.loads(pickle.dumps(changed)) == changed
    LIBRARY.forget([ID])


def test_its_gait_is_used_unless_it_does_not_divide_its_legs(stored: Robot) -> None:
    assert own_gait(stored) == "one-by-one"
    LIBRARY.describe(ID, About("Rex", "trot"))
    assert own_gait(robot(ID)) == "trot"
    assert own_gait(robot({"id": ID, "n_legs": 5})) == "one-by-one"


def test_an_id_alone_is_the_robot_too(stored: Robot) -> None:
    assert robot(ID) == stored
    with pytest.raises(InvalidInput, match="no stored robot"):
        robot("0" * 16)


@pytest.mark.parametrize("preset", [*PRESETS.values(), robot(BODY)], ids=lambda preset: preset.name)
def test_a_robot_by_value_needs_no_other(preset: Robot) -> None:
    value = by_value(preset)
    assert value is not None
    assert robot(value) == preset
