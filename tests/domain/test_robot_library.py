"""Libraries of stored robots: where a robot is found by its id, in this process and in others."""

import copy
import json
import pickle
import re
from pathlib import Path
from typing import Any

import pytest

from hexapods.domain.creatures import own_gait
from hexapods.domain.errors import DamagedFile, InvalidInput
from hexapods.domain.records import check_kept, from_json, to_json
from hexapods.domain.robot import as_mapping, document_of, read_document, robot
from hexapods.domain.robot_documents import id_of
from hexapods.domain.robot_library import LIBRARY, About, RobotLibrary
from hexapods.processes import Child, SetUp
from hexapods.runs.config import WalkingProblem

DOCUMENT = document_of(robot({"preset": "dog", "femur_m": 0.0777}))
ID = id_of(DOCUMENT)


def test_a_robot_is_found_in_the_library_that_is_passed_on_alone() -> None:
    library = RobotLibrary(documents=[DOCUMENT])
    assert robot({"id": ID}, library).femur_m == 0.0777
    for other in (RobotLibrary(), LIBRARY):
        with pytest.raises(InvalidInput, match=f"no stored robot '{ID}'"):
            robot({"id": ID}, other)


def test_two_libraries_with_different_robots_of_one_name_do_not_mix() -> None:
    libraries = [RobotLibrary(), RobotLibrary()]
    for femur_m, library in zip((0.08, 0.09), libraries, strict=True):
        data = document_of(robot({"preset": "dog", "femur_m": femur_m}))
        library.describe(library.add(data), About("Rex", "trot"))
    configs = [
        from_json(WalkingProblem, {"gait": "trot", "robot": robot_id}, context=library)
        for library in libraries
        for robot_id in library.documents
    ]
    assert [config.robot.name for config in configs] == ["Rex", "Rex"]
    assert [config.robot.femur_m for config in configs] == [0.08, 0.09]
    for config, library in zip(configs, reversed(libraries), strict=True):
        with pytest.raises(InvalidInput, match="stored here: Rex"):
            from_json(WalkingProblem, to_json(config), context=library)


def test_one_that_is_withdrawn_is_not_found_although_its_file_stays(tmp_path: Path) -> None:
    folders = [tmp_path / name for name in ("first", "second")]
    for folder in folders:
        folder.mkdir()
        (folder / f"{ID}.json").write_bytes(DOCUMENT)
    library = RobotLibrary()
    library.add_folder(tmp_path)
    assert library.get(ID) == DOCUMENT
    library.withdraw(folders[0], [ID])
    assert library.get(ID) == DOCUMENT, "of the other folder"
    library.withdraw(folders[1], [ID])
    for copied in (library, pickle.loads(pickle.dumps(library))):
        assert copied.get(ID) is None
    assert RobotLibrary(library, documents=[DOCUMENT]).get(ID) == DOCUMENT
    library.reinstate(folders[1], [ID])
    assert library.get(ID) == DOCUMENT


def test_documents_are_read_from_folders_and_checked(tmp_path: Path) -> None:
    (tmp_path / "database").mkdir()
    path = tmp_path / "database" / f"{ID}.json"
    path.write_bytes(DOCUMENT.replace(b"0.0777", b"0.0778"))
    library = RobotLibrary()
    library.add_folder(tmp_path)
    with pytest.raises(DamagedFile, match=f"the file of robot {ID} is damaged"):
        robot({"id": ID}, library)
    path.write_bytes(DOCUMENT)
    assert robot({"id": ID}, library).femur_m == 0.0777
    library.remove_folder(tmp_path)
    library.forget([ID])
    assert library.get(ID) is None


def test_a_library_extends_another_one_and_adds_nothing_to_it(tmp_path: Path) -> None:
    (tmp_path / f"{ID}.json").write_bytes(DOCUMENT)
    base = RobotLibrary()
    base.add_folder(tmp_path)
    base.describe(ID, About("Fido", "trot"))
    added = document_of(robot({"preset": "crab", "femur_m": 0.07}))
    library = RobotLibrary(base, [DOCUMENT, added])
    assert robot({"id": ID, "name": "Rex"}, library).name == "Fido"
    assert robot({"id": id_of(added), "name": "Pinch"}, library).name == "Pinch"
    assert base.get(id_of(added)) is None
    library.forget([ID])
    assert robot({"id": ID}, library).name == "Fido"


def test_the_error_names_what_is_stored_in_a_library_and_in_those_that_it_extends() -> None:
    base = RobotLibrary()
    base.describe(ID, About("Rex"))
    library = RobotLibrary(base)
    library.describe("1" * 16, About("Ada"))
    names = f"stored here: Ada ({'1' * 16}), Rex ({ID})"
    with pytest.raises(InvalidInput, match=re.escape(names)):
        robot({"id": "0" * 16}, library)
    with pytest.raises(InvalidInput, match="no robot is stored here"):
        robot({"id": "0" * 16}, RobotLibrary())


def test_what_is_written_adds_its_robots_documents_to_a_library() -> None:
    changed = robot({"id": ID, "friction": 0.5}, RobotLibrary(documents=[DOCUMENT]))
    config = WalkingProblem(gait="trot", robot=changed)
    library = RobotLibrary()
    written = json.dumps(to_json(config, library))
    assert library.documents == {ID: DOCUMENT}
    assert from_json(WalkingProblem, written.encode(), context=library) == config
    assert check_kept(config, RobotLibrary()) == config
    with pytest.raises(InvalidInput, match="no stored robot"):
        check_kept(config)


def test_a_pickled_robot_carries_its_document_and_changes_no_library() -> None:
    changed = robot({"id": ID, "friction": 0.5}, RobotLibrary(documents=[DOCUMENT]))
    assert copy.deepcopy(changed) == changed
    unpickled = pickle.loads(pickle.dumps(WalkingProblem(gait="trot", robot=changed))).robot
    assert unpickled == changed
    assert as_mapping(unpickled)["friction"] == 0.5
    assert LIBRARY.get(ID) is None


def test_a_pickled_library_finds_the_same(tmp_path: Path) -> None:
    (tmp_path / f"{ID}.json").write_bytes(DOCUMENT)
    library = RobotLibrary(RobotLibrary(documents=[document_of(robot("crab"))]))
    library.add_folder(tmp_path)
    library.describe(ID, About("Fido"))
    unpickled = pickle.loads(pickle.dumps(library))
    assert robot(ID, unpickled) == robot(ID, library)
    assert robot(ID, unpickled).name == "Fido"
    assert robot(id_of(document_of(robot("crab"))), unpickled) == robot("crab")


def _describe(pipe: Any) -> None:
    robots = [robot({"id": robot_id}) for robot_id in pipe.recv()]
    pipe.send([(entry.name, entry.femur_m, own_gait(entry)) for entry in robots])


def test_another_process_finds_what_this_one_finds(tmp_path: Path) -> None:
    (tmp_path / f"{ID}.json").write_bytes(DOCUMENT)
    LIBRARY.add_folder(tmp_path)
    LIBRARY.describe(ID, About("Fido", "trot"))
    in_memory = read_document(document_of(robot({"preset": "dog", "femur_m": 0.0666})))
    assert in_memory.id is not None
    child = Child(_describe, SetUp(name="describe"))
    child.start()
    child.pipe.send([ID, in_memory.id])
    assert child.pipe.recv() == [
        ("Fido", 0.0777, "trot"),
        (f"robot {in_memory.id[:6]}", 0.0666, "one-by-one"),
    ]
    child.end()
    LIBRARY.remove_folder(tmp_path)
    LIBRARY.forget([ID, in_memory.id])
