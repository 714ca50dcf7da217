"""Stored robots in a database and a folder."""

import stat
from contextlib import AbstractContextManager
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from sqlalchemy import text

from app.settings import ROBOTS_FOLDER, Settings
from app.storage.database import robots
from app.storage.database.deletions import RESTORABLE
from app.storage.database.read_only import open_read_only
from app.storage.database.store import RunStore
from app.storage.errors import Conflict, NotFound, StorageFull
from app.storage.run import Run
from app.storage.stored_robot import StoredRobot, distinct_name
from hexapods.domain import robot_documents
from hexapods.domain.errors import InvalidInput
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
    assert store.get("a").config == run.config
    store.delete("a")
    store.robots.delete(rex.id)
    assert store.robots.stored(hidden=True) == []


def an_hour_later(store: RunStore) -> None:
    """Purge as the server does it an hour after now."""
    store.deletions.now = lambda: datetime.now(UTC) + RESTORABLE + timedelta(seconds=1)
    store.deletions.purge()
    store.deletions.now = lambda: datetime.now(UTC)


def test_one_that_was_deleted_is_nowhere_and_comes_back_as_it_was(
    store: RunStore, tmp_path: Path
) -> None:
    add(store, body(), "Rex")
    rex = store.robots.change(robot_documents.id_of(document_of(body())), hidden=True)
    run = training("a", rex.robot)
    assert store.robots.delete(rex.id) is not None
    assert store.robots.stored(hidden=True) == []
    assert store.robots.find("Rex") is None
    for find in (store.robots.get, store.robots.document, store.robots.delete):
        with pytest.raises(NotFound):
            find(rex.id)
    with pytest.raises(InvalidInput, match="there is no stored robot"):
        robot({"id": rex.id})
    # A start that was under way, and names it.
    with pytest.raises(NotFound, match=f"robot {rex.id} was deleted: restore it first"):
        store.create(run)

    assert files_of(tmp_path) == [f"{rex.id}.json"]
    for _ in range(2):
        assert store.robots.restore(rex.id) == rex
    assert store.robots.stored(hidden=True) == [rex]
    assert robot({"id": rex.id}).name == "Rex"
    store.create(run)
    an_hour_later(store)
    assert store.robots.get(rex.id) == rex


def test_one_that_was_deleted_is_gone_an_hour_later_with_its_files(
    store: RunStore, tmp_path: Path
) -> None:
    rex = add(store, body(), "Rex")
    run = training("a", rex.robot)
    store.robots.delete(rex.id)
    an_hour_later(store)
    assert files_of(tmp_path) == []
    with pytest.raises(NotFound, match="can be restored for 1 h"):
        store.robots.restore(rex.id)
    with pytest.raises(NotFound, match=r"there is no robot '\w+' \(any more\)$"):
        store.create(run)


def test_one_that_was_deleted_can_be_restored_after_a_restart(tmp_path: Path) -> None:
    with stores.opened(tmp_path, None) as store:
        rex = add(store, body(), "Rex")
        store.robots.delete(rex.id)
    for open_again in (stores.opened, read_only):
        with open_again(tmp_path, None) as store:
            assert store.robots.stored(hidden=True) == []
            with pytest.raises(InvalidInput, match="there is no stored robot"):
                robot({"id": rex.id})
    with stores.opened(tmp_path, None) as store:
        assert store.robots.restore(rex.id) == rex
        assert robot({"id": rex.id}).name == "Rex"


def read_only(folder: Path, url: None) -> AbstractContextManager[RunStore]:
    return open_read_only(Settings(data=folder, database_url=url))


def test_the_name_of_one_that_was_deleted_is_free(store: RunStore) -> None:
    rex = add(store, body(), "Rex")
    store.robots.delete(rex.id)
    other = add(store, body(0.08), "rex")
    with pytest.raises(Conflict, match="a robot named 'Rex' by now; give that one another name"):
        store.robots.restore(rex.id)
    assert store.robots.stored() == [other]
    store.robots.change(other.id, name="Max")
    assert store.robots.restore(rex.id) == rex


def test_one_that_was_deleted_gives_way_to_the_same_robot(store: RunStore, tmp_path: Path) -> None:
    rex = add(store, body(), "Rex")
    store.robots.delete(rex.id)
    again = add(store, body(), "Rex again")
    assert again.name == "Rex again"
    assert store.robots.stored() == [again]
    assert store.robots.restore(rex.id) == again
    assert files_of(tmp_path) == [f"{rex.id}.json"]
    assert robot({"id": rex.id}).name == "Rex again"


def test_the_most_robots_are_counted_with_those_that_were_deleted(
    store: RunStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(robots, "MAX_ROBOTS", 2)
    rex, fido = add(store, body(), "Rex"), add(store, body(0.08), "Fido")
    with pytest.raises(StorageFull, match="at most 2 robots"):
        add(store, body(0.07), "Max")
    store.robots.delete(rex.id)
    pluto = add(store, body(0.07), "Max")
    with pytest.raises(NotFound):
        store.robots.restore(rex.id)
    assert store.robots.stored() == [fido, pluto]


def test_a_run_is_restored_after_its_robot(store: RunStore) -> None:
    rex = add(store, body(), "Rex")
    store.create(training("a", rex.robot))
    store.trash("a")
    store.robots.delete(rex.id)
    with pytest.raises(NotFound, match="was deleted: restore it first"):
        store.restore("a")
    store.robots.restore(rex.id)
    assert store.restore("a").id == "a"


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
