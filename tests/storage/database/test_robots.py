"""Stored robots in a database and a folder."""

import stat
from dataclasses import replace
from pathlib import Path

import pytest
from sqlalchemy import text

from app.settings import ROBOTS_FOLDER
from app.storage.database.store import RunStore
from app.storage.errors import Conflict, NotFound
from app.storage.run import Run
from app.storage.stored_robot import StoredRobot, distinct_name
from hexapods.domain import robot_documents
from hexapods.domain.gait import GaitSpec
from hexapods.domain.robot import Robot, document_of, robot
from hexapods.domain.robot_library import LIBRARY
from tests.storage import stores


def training(run_id: str, robot: Robot) -> Run:
    return stores.training(
        run_id, state="finished", config=replace(stores.PLAIN, gait="trot", robot=robot)
    )


def body(femur_m: float = 0.09) -> Robot:
    return robot({"preset": "dog", "femur_m": femur_m})


def add(store: RunStore, robot: Robot, name: str) -> StoredRobot:
    document = document_of(robot)
    about = StoredRobot(id=robot_documents.id_of(document), name=name, gait="trot")
    return store.robots.add(document, about)[0]


def files_of(folder: Path) -> list[str]:
    return sorted(path.name for path in (folder / ROBOTS_FOLDER).glob("*/*"))


def test_a_robot_is_stored_once_and_found_by_id_and_name(store: RunStore, tmp_path: Path) -> None:
    rex = add(store, body(), "Rex")
    assert add(store, body(), "Rex again") == rex
    assert store.robots.stored() == [rex]
    assert store.robots.find("rex") == store.robots.find(rex.id) == rex
    assert store.robots.find("Fido") is None
    assert rex.robot == body()
    assert store.robots.document(rex.id) == document_of(body())
    assert files_of(tmp_path) == [f"{rex.id}.json"]
    (path,) = (tmp_path / ROBOTS_FOLDER).glob("*/*")
    assert not stat.S_IMODE(path.parent.stat().st_mode) & 0o077


def test_it_is_there_after_a_restart_with_all_that_is_said_of_it(tmp_path: Path) -> None:
    with stores.opened(tmp_path, None) as store:
        rex = add(store, body(), "Rex")
        gait = GaitSpec(1, 2, groups=((1, 2), (3, 4)))
        changed = store.robots.change(rex.id, name="Max", hidden=True, gait=gait)
    LIBRARY.forget([rex.id])
    with stores.opened(tmp_path, None) as store:
        assert store.robots.get(rex.id) == changed
        assert store.robots.stored() == []
        assert store.robots.stored(hidden=True) == [changed]
        assert robot({"id": rex.id}).name == "Max"


def test_no_two_robots_have_one_name(store: RunStore) -> None:
    rex, fido = add(store, body(), "Rex"), add(store, body(0.08), "Fido")
    for name in ("rex", "Spider"):
        with pytest.raises(Conflict, match="choose another name"):
            add(store, body(0.07), name)
        with pytest.raises(Conflict, match="choose another name"):
            store.robots.change(fido.id, name=name)
    assert store.robots.change(rex.id, name="REX").name == "REX"
    assert distinct_name("Rex", ["rex", "Rex 2"]) == "Rex 3"
    assert len(distinct_name("x" * 100, ["x" * 100])) == 100


def test_it_is_deleted_unless_a_run_uses_it(store: RunStore, tmp_path: Path) -> None:
    rex, fido = add(store, body(), "Rex"), add(store, body(0.08), "Fido")
    run = training("a", rex.robot)
    store.create(run)
    with pytest.raises(Conflict, match=r"a run uses Rex.*hide it instead"):
        store.robots.delete(rex.id)
    store.robots.delete(fido.id)
    with pytest.raises(NotFound):
        store.robots.get(fido.id)
    assert files_of(tmp_path) == [f"{rex.id}.json"]
    assert store.get("a").config == run.config
    store.delete("a")
    store.robots.delete(rex.id)
    assert files_of(tmp_path) == []


def test_a_run_whose_robot_is_gone_is_not_started(store: RunStore) -> None:
    rex = add(store, body(), "Rex")
    run = training("a", rex.robot)
    store.robots.delete(rex.id)
    with pytest.raises(NotFound, match="there is no robot"):
        store.create(run)


def test_files_without_a_row_are_deleted_at_the_start(tmp_path: Path) -> None:
    with stores.opened(tmp_path, None) as store:
        rex = add(store, body(), "Rex")
    (folder,) = (tmp_path / ROBOTS_FOLDER).iterdir()
    (folder / f"{'0' * 16}.json").write_bytes(b"{}")
    (folder / f".{rex.id}.json.part").write_bytes(b"{")
    with stores.opened(tmp_path, None):
        assert files_of(tmp_path) == [f"{rex.id}.json"]


def test_a_damaged_row_is_left_out(store: RunStore) -> None:
    rex, fido = add(store, body(), "Rex"), add(store, body(0.08), "Fido")
    statement = f"UPDATE robots SET gait = '\"fly\"' WHERE id = '{rex.id}'"
    store.database.write(lambda connection: connection.exec_driver_sql(statement))
    assert store.robots.stored() == [fido]


def test_a_rename_is_seen_in_runs(store: RunStore) -> None:
    rex = add(store, body(), "Rex")
    store.create(training("a", rex.robot))
    assert store.get("a").config.robot.name == "Rex"
    store.robots.change(rex.id, name="Max")
    assert store.get("a").config.robot.name == "Max"


def test_a_robot_whose_row_is_damaged_can_be_deleted_and_stored_again(store: RunStore) -> None:
    rex = add(store, body(), "Rex")
    damage = text("UPDATE robots SET guesses = '{}'")
    for way in ("stored", "deleted"):
        store.database.write(lambda connection: connection.execute(damage))
        with pytest.raises(NotFound):
            store.robots.get(rex.id)
        if way == "deleted":
            store.robots.delete(rex.id)
        assert add(store, body(), "Rex").name == "Rex"
        assert store.robots.get(rex.id).robot == body()
