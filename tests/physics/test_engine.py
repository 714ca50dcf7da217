"""An engine other than the pinned one is told where the physics is imported."""

import subprocess
import sys
import tomllib
from pathlib import Path

from hexapods.physics import engine

ROOT = Path(__file__).parents[2]
OTHER = "import mujoco; mujoco.__version__ = '3.17.0'; import hexapods.physics"


def test_the_pinned_version_is_that_of_the_project_and_is_loaded() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert f"mujoco-core=={engine.PINNED}" in project["dependencies"]
    assert engine.loaded_version() == engine.PINNED
    assert engine.mismatch() is None


def test_importing_the_physics_warns_of_another_engine_and_says_what_to_do() -> None:
    command = [sys.executable, "-c", OTHER]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0
    assert (
        "RuntimeWarning: the MuJoCo that is loaded is 4.0.0 with the bindings of 3.17.0, and "
        in (done.stderr)
    )
    assert f"has to be {engine.PINNED}" in done.stderr
    assert f"pip install mujoco-core=={engine.PINNED}" in done.stderr
