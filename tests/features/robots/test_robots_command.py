"""`hexapods robots`, as a user runs it."""

import json
from pathlib import Path

import mujoco
import pytest

from hexapods.domain.creatures import CREATURES
from tests.cli.running import in_process, output, refusal


def test_built_in_robots_are_listed(tmp_path: Path) -> None:
    listed = in_process("robots", "list", folder=tmp_path).stdout
    rows = json.loads(in_process("robots", "list", "--json", folder=tmp_path).stdout)

    assert [row["name"] for row in rows] == list(CREATURES)
    assert rows[-1]["gait"] == "tripod"
    assert all(name in listed for name in CREATURES)


def test_a_robot_that_tips_is_reported_with_groups_that_stand(tmp_path: Path) -> None:
    shown = in_process("robots", "show", "dog", "--gait", "pace", folder=tmp_path).stdout

    assert "dog, pace: 4 legs" in shown
    assert "A table has 25 states with 8 actions each, 200 values: it fits into memory." in shown
    assert "0.67 m in 50" in shown
    assert "It tips: the least support margin is -173 mm." in shown
    assert "With the groups [1, 3] [2, 4] it stands: 0 mm, 25 states." in shown
    assert "Learner to begin with: multilevel-model. It tips while a group swings" in shown


def test_a_robot_is_shown_with_the_gait_that_suits_it(tmp_path: Path) -> None:
    shown = in_process("robots", "show", "starfish", "--json", folder=tmp_path)
    preview = json.loads(shown.stdout)

    assert preview["gait"]["groups"] == [[1, 3], [2, 5], [4]]
    assert preview["tips"] is False
    assert preview["states"] == 125


def test_a_gait_that_makes_no_sense_is_refused(tmp_path: Path) -> None:
    error = refusal("robots", "show", "dog", "--gait", "tripod", folder=tmp_path)

    assert "it needs six legs, this robot has 4" in error


def test_a_robot_is_exported_as_a_model_for_mujoco(tmp_path: Path) -> None:
    out = ("--out", "dog.xml")
    result = output("robots", "export", "dog", *out, folder=tmp_path, run=in_process)
    assert result == {
        "robot": "dog",
        "file": "dog.xml",
        "bytes": (tmp_path / "dog.xml").stat().st_size,
    }
    assert mujoco.MjModel.from_xml_path(str(tmp_path / "dog.xml")).key("home").id == 0
    assert [*tmp_path.iterdir()] == [tmp_path / "dog.xml"]
    said = in_process("robots", "export", '{"n_legs": 8}', "--out", "own.xml", folder=tmp_path)
    assert said.stdout.startswith("stiff (modified) is in own.xml (")


@pytest.mark.parametrize("file", ["dog.urdf", "dog.zip", "dog.xml"])
def test_an_exported_robot_is_imported_as_the_same(file: str, tmp_path: Path) -> None:
    output("robots", "export", "dog", "--out", file, folder=tmp_path, run=in_process)
    stored = output("robots", "import", file, "--name", "Rex", folder=tmp_path, run=in_process)
    assert stored["gait"] == "trot"
    grid = ("--grid-side-m", "0.04")
    shown = output("robots", "show", "Rex", *grid, folder=tmp_path, run=in_process)
    original = output("robots", "show", "dog", *grid, folder=tmp_path, run=in_process)
    assert shown["gait"] == original["gait"]
    assert shown["mass_kg"] == pytest.approx(original["mass_kg"])
    assert shown["law_m"] == pytest.approx(original["law_m"])


def test_a_robot_that_cannot_be_exported_is_refused(tmp_path: Path) -> None:
    def refused(*arguments: str) -> str:
        return refusal("robots", "export", *arguments, folder=tmp_path, run=in_process)

    assert "unknown robot 'cat'; choose one of: stiff" in refused("cat", "--out", "cat.xml")
    endings = "must end with .json, .xml, .urdf or .zip"
    assert f"{endings}: dog.sdf" in refused("dog", "--out", "dog.sdf")
    assert "cannot write no/dog.xml" in refused("dog", "--out", "no/dog.xml")
    assert not [*tmp_path.iterdir()]
