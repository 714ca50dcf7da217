"""Stored robots on the command line: with the data folder alone, and through its server."""

import json
from pathlib import Path
from typing import Any

import pytest

from hexapods.domain import robot_documents
from hexapods.domain.robot import document_of, robot
from tests.cli.running import in_process, output, refusal
from tests.imports.robots import FOUR, HOME, dog
from tests.served import Served

BODY = {"preset": "dog", "femur_m": 0.0955}
ID = robot_documents.id_of(document_of(robot(BODY)))
WALK = ("--gait", "trot", "--simulator", "kinematic")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "rex.json").write_bytes(document_of(robot(BODY)))
    return tmp_path


def robots_json(folder: Path, *arguments: str) -> Any:
    data = ("--data", str(folder / "data"))
    return output("robots", *arguments, *data, folder=folder, run=in_process)


def names(folder: Path, *arguments: str) -> list[str]:
    return [
        entry["name"]
        for entry in robots_json(folder, "list", *arguments)
        if entry["id"] is not None
    ]


def test_a_robot_is_imported_shown_hidden_renamed_and_deleted(folder: Path) -> None:
    imported = robots_json(folder, "import", "rex.json", "--name", "Rex")
    assert (imported["id"], imported["name"]) == (ID, "Rex")
    assert robots_json(folder, "import", "rex.json", "--name", "Max")["name"] == "Rex"
    assert names(folder) == ["Rex"]
    assert robots_json(folder, "show", "rex")["states"] == 25
    assert robots_json(folder, "show", ID, "--gait", "one-by-one")["states"] == 625
    robots_json(folder, "hide", "Rex")
    assert (names(folder), names(folder, "--hidden")) == ([], ["Rex"])
    robots_json(folder, "hide", "Rex", "--undo")
    robots_json(folder, "rename", "Rex", "--name", "Max")
    robots_json(folder, "export", "Max", "--out", "max.json")
    assert (folder / "max.json").read_bytes() == (folder / "rex.json").read_bytes()
    assert robots_json(folder, "delete", "max") == {"deleted": ID}
    assert names(folder, "--hidden") == []


def test_a_folder_is_imported_under_its_name(folder: Path) -> None:
    (folder / "My dog" / "mjcf").mkdir(parents=True)
    (folder / "My dog" / "mjcf" / "dog.xml").write_text(dog())

    imported = robots_json(folder, "import", "My dog")

    assert (imported["name"], imported["file"]) == ("My dog", "My dog.zip")
    (folder / "empty").mkdir()
    data = ("--data", str(folder / "data"))
    refused = refusal("robots", "import", "empty", *data, folder=folder, run=in_process)
    assert "it has no document of a robot" in refused


def test_what_was_read_is_told_corrected_and_drawn(folder: Path) -> None:
    (folder / "dog.xml").write_text(dog(keyframes={"home": HOME}))
    data = ("--data", str(folder / "data"))

    def imported(*arguments: str) -> str:
        done = in_process("robots", "import", "dog.xml", *arguments, *data, folder=folder)
        assert done.returncode == 0, done.stderr
        return done.stdout

    told = imported("--picture", "dog.png")
    assert "dog.xml is robot dog 2" in told, "a preset is called dog"
    assert "It has 4 legs and 8.4 kg" in told
    assert "1 FR_hip_joint, FR_thigh_joint, FR_calf_joint to FR" in told
    assert "Guessed: forward is x" in told
    assert (folder / "dog.png").read_bytes().startswith(b"\x89PNG")
    assert "forward is x" not in imported("--choices", '{"forward": "-x"}')
    (folder / "two.xml").write_text(dog({leg: FOUR[leg] for leg in ("FL", "FR")}))
    two = ("import", "two.xml", "--picture", "two.png")
    refused = in_process("robots", *two, *data, folder=folder).stderr
    assert "found 2 legs" in refused
    assert "What could be feet: FL, FR" in refused
    assert (folder / "two.png").read_bytes().startswith(b"\x89PNG")


def test_choices_and_pictures_that_cannot_be_are_refused(folder: Path) -> None:
    (folder / "dog.xml").write_text(dog())

    def refused(*arguments: str) -> str:
        data = ("--data", str(folder / "data"))
        return refusal("robots", "import", *arguments, *data, folder=folder, run=in_process)

    assert "JSON object" in refused("dog.xml", "--choices", "forward=y")
    assert "up" in refused("dog.xml", "--choices", '{"up": "w"}')
    assert "end with .png" in refused("dog.xml", "--picture", "dog.jpg")
    assert "are for MJCF" in refused("rex.json", "--picture", "rex.png")


def test_invalid_files_names_and_robots_are_refused(folder: Path) -> None:
    def refused(*arguments: str) -> str:
        data = ("--data", str(folder / "data"))
        return refusal("robots", *arguments, *data, folder=folder, run=in_process)

    assert "cannot read no.json" in refused("import", "no.json")
    (folder / "bad.json").write_text('{"format":"hexapods-robot-1"}')
    assert "is damaged" in refused("import", "bad.json")
    assert "unknown stored robot 'cat'; choose one of: none yet" in refused("delete", "cat")
    robots_json(folder, "import", "rex.json", "--name", "Rex")
    assert "unknown stored robot 'cat'; choose one of: Rex" in refused("hide", "cat")
    assert "unknown robot 'cat'; choose one of: stiff" in refused("show", "cat")
    assert "Rex" in refused("show", "cat")
    assert "choose another name" in refused("rename", "Rex", "--name", "stiff")


def test_it_walks_by_name_and_its_table_knows_it(folder: Path) -> None:
    data = {"HEXAPODS_DATA": str(folder / "data")}
    robots_json(folder, "import", "rex.json", "--name", "Rex")

    def run(*arguments: str) -> Any:
        done = in_process(*arguments, "--json", folder=folder, **data)
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    steps = ("--steps", "60", "--out", "q.npz")
    trained = run("train", *WALK, "--robot", "Rex", *steps)
    assert trained["config"]["robot"] == {"id": ID, "name": "Rex"}
    lanes = ("--lane", "q-learning=q.npz", "--lane", "greedy", "--steps", "4")
    assert run("race", *WALK, "--robot", ID, *lanes)["config"]["robot"]["id"] == ID
    changed = json.dumps({"id": ID, "friction": 0.5})
    assert run("race", *WALK, "--robot", changed, *lanes)["config"]["robot"]["friction"] == 0.5
    plan = ("--seeds", "2", "--steps", "20", "--agent", "q-learning", "--workers", "1")
    swept = run("sweep", *WALK, "--robot", "Rex", *plan)
    assert "Rex" in json.dumps(swept)
    elsewhere = refusal("race", *WALK, *lanes, folder=folder, HEXAPODS_DATA="none")
    assert f"there is no stored robot '{ID}' (Rex); import its document" in elsewhere


def test_a_running_server_is_asked(folder: Path) -> None:
    served = Served(folder / "data")
    try:
        assert robots_json(folder, "import", "rex.json")["name"] == "rex"
        assert names(folder) == ["rex"]
        robots_json(folder, "rename", "rex", "--name", "Rex")
        robots_json(folder, "hide", "Rex")
        assert (names(folder), names(folder, "--hidden")) == ([], ["Rex"])
        assert robots_json(folder, "delete", ID) == {"deleted": ID}
        assert names(folder, "--hidden") == []
    finally:
        served.end()


def test_a_robot_from_a_file_is_imported_with_what_was_guessed(folder: Path) -> None:
    (folder / "spot.xml").write_text(dog())
    data = ("--data", str(folder / "data"))
    said = in_process("robots", "import", "spot.xml", *data, folder=folder)
    assert said.returncode == 0, said.stderr
    assert "is robot spot (" in said.stdout
    assert "Guessed: " in said.stdout
    assert robots_json(folder, "show", "spot")["states"] == 25
    robots_json(folder, "export", "spot", "--out", "out.xml")
    robots_json(folder, "export", "spot", "--out", "out.json")
    robots_json(folder, "delete", "spot")
    assert robots_json(folder, "import", "out.json", "--name", "Spot")["name"] == "Spot"
    refused = refusal("robots", "import", "no.xml", *data, folder=folder, run=in_process)
    assert "cannot read no.xml" in refused
