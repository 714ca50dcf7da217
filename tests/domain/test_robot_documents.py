"""Stored robots: documents by content hash, and robots that are read from them by id."""

import copy
import pickle
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
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
from hexapods.domain.robot_documents import About
from hexapods.domain.tolerance import build_tolerance
from hexapods.processes import Child, SetUp
from hexapods.runs.config import WalkingProblem
from hexapods.runs.seeding import BUILDING, generator

BODY = {"preset": "dog", "femur_m": 0.09, "body_height_m": 0.1}


ID = robot_documents.id_of(document_of(robot(BODY)))


@pytest.fixture
def stored() -> Iterator[Robot]:
    """A stored robot, forgotten after the test."""
    yield read_document(document_of(robot(BODY)), "Rex")
    robot_documents.forget([ID])


@pytest.mark.parametrize("name", CREATURES)
def test_a_document_holds_the_robot_to_the_last_bit(name: str) -> None:
    data = document_of(PRESETS[name])
    made = read_document(data)
    assert made == PRESETS[name]
    assert made.id == robot_documents.id_of(data) == robot_documents.id_of(document_of(made))
    robot_documents.forget([robot_documents.id_of(data)])


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
    robot_documents.tell(ID, About("Rex"))
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
    robot_documents.tell(ID, About("New"))
    assert robot({"id": ID, "name": "Old"}).name == "New"
    assert robot({"id": ID, "name": "Old"}) == stored


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"id": "0" * 16, "name": "Rex"}, "no stored robot '0000000000000000' (Rex); import its"),
        ({"id": "xyz"}, "16 hexadecimal digits"),
        ({"id": 5}, "16 hexadecimal digits"),
        ({"id": "0" * 16, "preset": "dog"}, "not both"),
        ({"id": "0" * 16, "name": 5}, "name must be a text"),
        ({"id": "../../../../etc"}, "16 hexadecimal digits"),
    ],
)
def test_what_is_no_stored_robot_is_refused(given: dict[str, Any], told: str) -> None:
    with pytest.raises(InvalidInput, match=re.escape(told)):
        robot(given)


def test_the_error_names_what_is_stored_here(stored: Robot) -> None:
    robot_documents.tell(ID, About("Rex"))
    with pytest.raises(InvalidInput, match=re.escape(f"stored here: Rex ({ID})")):
        robot({"id": "0" * 16})


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


def test_documents_are_read_from_folders_and_checked(tmp_path: Path) -> None:
    data = document_of(robot({"preset": "spider", "femur_m": 0.1234}))
    robot_id = robot_documents.id_of(data)
    (tmp_path / "one").mkdir()
    path = tmp_path / "one" / f"{robot_id}.json"
    path.write_bytes(data.replace(b"0.1234", b"0.1235"))
    robot_documents.use_folder(tmp_path)
    with pytest.raises(DamagedFile, match=f"the file of robot {robot_id} is damaged"):
        robot({"id": robot_id})
    path.write_bytes(data)
    assert robot({"id": robot_id}).femur_m == 0.1234


def test_a_pickled_robot_brings_its_document(stored: Robot) -> None:
    changed = robot({"id": ID, "friction": 0.5})
    data = pickle.dumps(WalkingProblem(gait="trot", robot=changed))
    assert copy.deepcopy(changed) == changed
    robot_documents.forget([ID])
    with pytest.raises(InvalidInput):
        robot({"id": ID})
    read = pickle.loads(data).robot
    assert read == changed
    assert as_mapping(read)["friction"] == 0.5


def test_a_robot_is_written_and_pickled_where_its_document_is_not_known_any_more() -> None:
    made = read_document(document_of(robot(BODY)), "Rex")
    changed = robot({"id": ID, "name": "Rex", "friction": 0.5})
    robot_documents.forget([ID])
    assert as_mapping(made) == {"id": ID, "name": "Rex"}
    assert as_mapping(changed) == {"id": ID, "name": "Rex", "friction": 0.5}
    assert pickle.loads(pickle.dumps(changed)) == changed
    robot_documents.forget([ID])


def _describe(pipe: Any) -> None:
    made = robot({"id": pipe.recv()})
    pipe.send((made.name, made.femur_m, own_gait(made)))


def test_another_process_finds_what_this_one_finds(tmp_path: Path) -> None:
    data = document_of(robot({"preset": "dog", "femur_m": 0.0777}))
    robot_id = robot_documents.id_of(data)
    (tmp_path / f"{robot_id}.json").write_bytes(data)
    robot_documents.use_folder(tmp_path)
    robot_documents.tell(robot_id, About("Fido", "trot"))
    child = Child(_describe, SetUp(name="describe"))
    child.start()
    child.pipe.send(robot_id)
    assert child.pipe.recv() == ("Fido", 0.0777, "trot")
    child.end()
    robot_documents.forget([robot_id])


def test_lent_documents_are_there_for_a_while() -> None:
    data = document_of(robot({"preset": "crab", "femur_m": 0.07}))
    with robot_documents.lent([data]):
        assert robot({"id": robot_documents.id_of(data)}).femur_m == 0.07
    with pytest.raises(InvalidInput):
        robot({"id": robot_documents.id_of(data)})


def test_what_is_told_of_a_stored_robot_outlasts_its_lending(tmp_path: Path) -> None:
    data = document_of(robot({"preset": "crab", "femur_m": 0.071}))
    robot_id = robot_documents.id_of(data)
    (tmp_path / f"{robot_id}.json").write_bytes(data)
    robot_documents.use_folder(tmp_path)
    robot_documents.tell(robot_id, About("Pinch", "trot"))
    with robot_documents.lent([data]):
        assert robot({"id": robot_id}).name == "Pinch"
    assert robot({"id": robot_id}).name == "Pinch"
    assert own_gait(robot({"id": robot_id})) == "trot"
    robot_documents.leave_folder(tmp_path)
    robot_documents.forget([robot_id])


def test_its_gait_is_told_unless_it_does_not_divide_its_legs(stored: Robot) -> None:
    assert own_gait(stored) == "one-by-one"
    robot_documents.tell(ID, About("Rex", "trot"))
    assert own_gait(robot(ID)) == "trot"
    assert own_gait(robot({"id": ID, "n_legs": 5})) == "one-by-one"


def test_an_id_alone_is_the_robot_too(stored: Robot) -> None:
    assert robot(ID) == stored
    with pytest.raises(InvalidInput, match="no stored robot"):
        robot("0" * 16)


@pytest.mark.parametrize("made", [*PRESETS.values(), robot(BODY)], ids=lambda one: one.name)
def test_a_robot_by_value_needs_no_other(made: Robot) -> None:
    value = by_value(made)
    assert value is not None
    assert robot(value) == made
