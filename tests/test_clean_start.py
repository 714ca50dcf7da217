"""Processes import neither the program that starts them, nor what its folder shadows."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.imports.robots import bug

pytestmark = pytest.mark.promises

LOAD = """
import hexapods as hx
print("legs", len(hx.load_robot("bug.urdf").legs))
"""
SPAWN = """
import multiprocessing
from hexapods import processes
processes.process_context = lambda: multiprocessing.get_context("spawn")
"""
"""Lets processes start as they do on macOS and Windows."""
SHADOWED = ("signal", "socket", "types", "json")
"""Modules that a process imports before anything of this product."""


def legs_of(folder: Path, *arguments: str, program: str = "") -> str:
    """Return what a program prints that reads a robot, with `program` as its standard input."""
    (folder / "bug.urdf").write_text(bug())
    done = subprocess.run(
        [sys.executable, *arguments],
        input=program,
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(Path(__file__).parents[1])},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout


def test_a_program_without_a_guard_reads_a_robot_once(tmp_path: Path) -> None:
    (tmp_path / "program.py").write_text(LOAD)

    assert legs_of(tmp_path, "program.py") == "legs 6\n"


@pytest.mark.parametrize("method", ["", SPAWN], ids=["usual", "spawned"])
def test_a_program_from_standard_input_reads_a_robot(tmp_path: Path, method: str) -> None:
    assert legs_of(tmp_path, "-", program=method + LOAD) == "legs 6\n"


def test_a_module_that_is_run_reads_a_robot(tmp_path: Path) -> None:
    (tmp_path / "program.py").write_text(LOAD)

    assert legs_of(tmp_path, "-m", "program") == "legs 6\n"


@pytest.mark.parametrize("method", ["", SPAWN], ids=["usual", "spawned"])
def test_modules_in_the_working_folder_shadow_none_of_pythons(tmp_path: Path, method: str) -> None:
    program, folder = tmp_path / "program.py", tmp_path / "elsewhere"
    program.write_text(method + LOAD)
    folder.mkdir()
    for name in SHADOWED:
        (folder / f"{name}.py").write_text("raise SystemExit('shadowed')\n")

    assert legs_of(folder, str(program)) == "legs 6\n"
