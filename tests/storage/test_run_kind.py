"""Kinds of runs: those that are installed, also of another package."""

import os
import subprocess
import sys
from pathlib import Path

from app.storage.run_kind import WALKS, added_kinds, run_kinds

REGATTA = """
from app.storage.run_kind import RunKind


class Regatta(RunKind):
    name = "regatta"


KIND = Regatta()
"""


def test_those_of_the_core_come_first() -> None:
    names = tuple(run_kinds())
    assert names[: len(WALKS)] == WALKS
    assert {kind.name for kind in added_kinds()} == set(names[len(WALKS) :])


def test_another_package_adds_one(tmp_path: Path) -> None:
    about = tmp_path / "hexapods_sailing-1.0.dist-info"
    about.mkdir()
    (tmp_path / "hexapods_sailing.py").write_text(REGATTA)
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: hexapods-sailing\nVersion: 1\n")
    (about / "entry_points.txt").write_text("[hexapods.run_kinds]\nsailing = hexapods_sailing\n")
    # In a process of its own, as the kinds are read once.
    code = (
        "from app.storage.run_kind import kinds_without, run_kinds; "
        "print(list(run_kinds())[-1], 'regatta' in kinds_without(['sailing']))"
    )
    environment = {**os.environ, "PYTHONPATH": f"{tmp_path}{os.pathsep}{Path.cwd()}"}
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert done.stdout == "regatta False\n"
