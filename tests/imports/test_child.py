import os
import subprocess
import sys
import threading
import time
from pathlib import Path

import psutil
import pytest

from hexapods.domain.errors import DamagedFile, InvalidInput
from hexapods.imports.child import NotRead, ReadingLimits, read_robot_file
from hexapods.imports.choices import Choices
from tests.imports.robots import HOME, box_triangles, bug, dog, read, stl, zipped

NAME = "robot import"


def children() -> list[psutil.Process]:
    return [
        process
        for process in psutil.process_iter(["name", "username"])
        if process.info["name"] == NAME and process.pid in _descendants()
    ]


def _descendants() -> set[int]:
    return {child.pid for child in psutil.Process().children(recursive=True)}


@pytest.fixture
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    return tmp_path


def test_a_child_reads_the_same_robot(temporary: Path) -> None:
    text = dog(keyframes={"home": HOME})
    choices = Choices(forward="y", home_rad={"FR_hip_joint": 0.1}, gait="bound")

    robot = read_robot_file(text.encode(), "dog.xml", choices)

    assert robot == read(text, choices=choices)
    assert list(temporary.iterdir()) == []
    assert children() == []


def test_the_parent_imports_no_parser_of_robots(temporary: Path) -> None:
    script = (
        "import sys\n"
        "from hexapods.imports.child import read_robot_file\n"
        "if __name__ == '__main__':\n"
        "    robot = read_robot_file(open(sys.argv[1], 'rb').read())\n"
        "    parsers = ('mujoco', 'hexapods.imports.documents.xml', 'xml.parsers.expat')\n"
        "    print(len(robot.legs), *(name in sys.modules for name in parsers))\n"
    )
    file, program = temporary / "bug.urdf", temporary / "program.py"
    file.write_text(bug())
    program.write_text(script)
    paths = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}

    done = subprocess.run(
        [sys.executable, program, file], capture_output=True, text=True, check=True, env=paths
    )

    assert done.stdout.split() == ["6", "False", "False", "False"]


def test_its_sentence_comes_back() -> None:
    with pytest.raises(DamagedFile, match="line 1"):
        read_robot_file(b"<mujoco", "dog.xml")
    with pytest.raises(InvalidInput, match="found 2 legs"):
        read_robot_file(dog({"FL": (0.2, 0.1), "FR": (0.2, -0.1)}).encode())


def test_a_file_that_takes_too_long_to_read_is_refused(temporary: Path) -> None:
    began_s = time.monotonic()

    with pytest.raises(DamagedFile, match=r"longer than 0(\.01)? s"):
        read_robot_file(bug().encode(), limits=ReadingLimits(seconds=0, clock_seconds=0.01))

    assert time.monotonic() - began_s < 30
    assert children() == []
    assert list(temporary.iterdir()) == []


def test_a_busy_machine_is_not_blamed_on_the_file() -> None:
    with pytest.raises(NotRead, match=r"the machine is busy: within 0\.01 s it spent only 0\.\d s"):
        read_robot_file(bug().encode(), limits=ReadingLimits(clock_seconds=0.01))

    assert children() == []


def test_a_file_that_takes_too_much_memory_is_refused(temporary: Path) -> None:
    mesh = stl(box_triangles((1, 1, 1), cells=170))
    shapes = "".join(
        f'<visual><geometry><mesh filename="{name}.stl"/></geometry></visual>' for name in "ab"
    )
    data = zipped({"bug.urdf": bug(torso=shapes), "a.stl": mesh, "b.stl": mesh})

    with pytest.raises(DamagedFile, match="more than 48 MB"):
        read_robot_file(data, limits=ReadingLimits(memory_bytes=48 << 20))

    assert children() == []
    assert list(temporary.iterdir()) == []


@pytest.mark.skipif(sys.platform != "linux", reason="the name of a process is set on Linux")
def test_a_killed_child_process_is_reported() -> None:
    def kill() -> None:
        while not (processes := children()):
            time.sleep(0.005)
        processes[0].kill()

    killer = threading.Thread(target=kill)
    killer.start()
    mesh = stl(box_triangles((1, 1, 1), cells=100))
    torso = '<visual><geometry><mesh filename="a.stl"/></geometry></visual>'

    with pytest.raises((DamagedFile, NotRead), match=r"breaks down|longer than|as it began"):
        read_robot_file(zipped({"bug.urdf": bug(torso=torso), "a.stl": mesh}))

    killer.join()
    assert children() == []


def test_a_child_that_cannot_begin_says_nothing_of_the_file(temporary: Path) -> None:
    (temporary / "mujoco.py").write_text("raise SystemExit\n")
    (temporary / "bug.urdf").write_text(bug())
    script = (
        "from hexapods.imports.child import NotRead, read_robot_file\n"
        "try:\n"
        "    read_robot_file(open('bug.urdf', 'rb').read())\n"
        "except NotRead as error:\n"
        "    print(error)\n"
    )
    environment = {
        **os.environ,
        "PYTHONPATH": str(Path(__file__).parents[2]),
        "PYTHONDONTWRITEBYTECODE": "1",
    }

    done = subprocess.run(
        [sys.executable, "-"],
        check=False,
        input=script,
        cwd=temporary,
        env=environment,
        capture_output=True,
        text=True,
    )

    assert "cannot be started (it ended as it began)" in done.stdout, done.stderr
    assert {path.name for path in temporary.iterdir()} == {"bug.urdf", "mujoco.py"}


@pytest.mark.parametrize(
    "name", ["$(touch owned).xml", "; rm -rf ~", "../../robot\0.xml", "\u202elmx"]
)
def test_names_are_only_text(name: str, temporary: Path) -> None:
    robot = read_robot_file(dog().replace('model="dog"', "").encode(), name)

    assert "\0" not in robot.name
    assert "\u202e" not in robot.name
    assert list(temporary.iterdir()) == []
