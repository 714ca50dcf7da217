"""Stored robots travel in the archives of runs that use them."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from app.features.archives import archive
from app.features.archives.transfer import RUN
from app.storage.database.store import RunStore
from app.storage.run import Run
from app.storage.run_ids import RunIds
from app.storage.stored_robot import StoredRobot
from hexapods.domain import robot_documents
from hexapods.domain.errors import DamagedFile, InvalidInput
from hexapods.domain.robot import Robot, document_of, robot
from hexapods.runs.results import RaceResult
from tests.features.archives.exported import export_run, import_run
from tests.storage.ended_runs import ended_race, ended_training
from tests.storage.stores import opened, temporary_store

TRAINING, RACED = "00000000000t1", "00000000000r1"
DOCUMENT = document_of(robot({"preset": "dog", "femur_m": 0.09}))
ID = robot_documents.id_of(DOCUMENT)
MEMBER = f"robot-{ID}.json"


def stored(store: RunStore, document: bytes = DOCUMENT, name: str = "Rex") -> Robot:
    about = StoredRobot(id=robot_documents.id_of(document), name=name)
    return store.robots.add(document, about)[0].robot


@pytest.fixture(scope="module")
def exported(tmp_path_factory: pytest.TempPathFactory) -> Iterator[bytes]:
    """A race of a stored robot, in an archive; the robot is not known any more."""
    with opened(tmp_path_factory.mktemp("source"), None) as store:
        rex = stored(store)
        ended_training(store, TRAINING, robot=rex, gait="trot")
        ended_race(store, RACED, TRAINING, robot=rex, gait="trot")
        data = export_run(store, RACED)
        for run_id in (RACED, TRAINING):
            store.delete(run_id)
        store.robots.delete(ID)
        yield data


def members(data: bytes) -> dict[str, bytes]:
    return archive.unpack(data, "the archive", lambda _: True)


def imported(store: RunStore, data: bytes) -> Run:
    return import_run(store, data, RunIds(), "run.zip")


def test_an_archive_brings_its_robot(exported: bytes) -> None:
    assert members(exported)[MEMBER] == DOCUMENT
    with temporary_store() as store:
        run = imported(store, exported)
        (rex,) = store.robots.stored()
        assert (rex.id, rex.name, rex.gait, rex.hidden) == (ID, "Rex", "trot", False)
        assert store.get(run.id).config.robot == robot({"id": ID})
        assert members(export_run(store, run.id))[MEMBER] == DOCUMENT
        imported(store, exported)
        assert len(store.robots.stored()) == 1
        for item in store.list().items:
            store.delete(item.id)
        store.robots.delete(ID)


def test_its_name_is_made_distinct(exported: bytes) -> None:
    with temporary_store() as store:
        other = stored(store, document_of(robot({"preset": "dog", "femur_m": 0.08})))
        imported(store, exported)
        assert [item.name for item in store.robots.stored()] == ["Rex", "Rex 2"]
        for item in store.list().items:
            store.delete(item.id)
        store.robots.delete(ID)
        store.robots.delete(str(other.id))


def test_a_table_of_another_stored_robot_brings_that_too(tmp_path: Path) -> None:
    with opened(tmp_path, None) as store:
        rex = stored(store)
        other = stored(store, document_of(robot({"preset": "dog", "femur_m": 0.08})), "Fido")
        ended_training(store, TRAINING, robot=rex, gait="trot")
        race = ended_race(store, RACED, TRAINING, robot=other, gait="trot")
        assert isinstance(race.result, RaceResult)
        archive_members = members(export_run(store, RACED))
        assert {name for name in archive_members if name.startswith("robot-")} >= {
            f"robot-{other.id}.json"
        }


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda files: files.pop(MEMBER), r"no stored robot .* \(Rex\); import its document"),
        (
            lambda files: files.update({MEMBER: DOCUMENT.replace(b"0.09", b"0.08")}),
            "the document of another robot",
        ),
        (lambda files: files.update({MEMBER: DOCUMENT[:-1]}), "cannot be taken in"),
        (lambda files: files.update({MEMBER: b"{}"}), "cannot be taken in"),
        (
            lambda files: files.update({f"robot-{'0' * 16}.json": DOCUMENT}),
            "the document of another robot",
        ),
        (
            lambda files: files.update({_member_of(0.07): _document(0.07)}),
            "which its run does not use",
        ),
        (
            lambda files: files.update({RUN: files[RUN].replace(ID.encode(), b"0" * 16)}),
            "no stored robot '0000000000000000'",
        ),
    ],
)
def test_a_robot_that_does_not_fit_the_run_is_refused(
    exported: bytes, change: object, message: str
) -> None:
    files = members(exported)
    change(files)  # type: ignore[operator]
    with temporary_store() as store:
        with pytest.raises((DamagedFile, InvalidInput), match=message):
            imported(store, archive.pack(files))
        assert store.list().items == []
        assert store.robots.stored(hidden=True) == []
        with pytest.raises(InvalidInput):
            robot({"id": ID})


def _document(femur_m: float) -> bytes:
    return document_of(robot({"preset": "dog", "femur_m": femur_m}))


def _member_of(femur_m: float) -> str:
    return f"robot-{robot_documents.id_of(_document(femur_m))}.json"
