"""`import hexapods as hx`: its names, what importing it costs, and what it never imports."""

import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import hexapods as hx
from hexapods import public
from hexapods.agents.registry import OURS


def printed(program: str, folder: Path) -> str:
    """Run a program in a folder, and return what it prints."""
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def test_importing_it_loads_and_starts_nothing(tmp_path: Path) -> None:
    program = (
        "import hexapods, sys, threading\n"
        "print({'numpy', 'mujoco', 'gymnasium', 'fastapi', 'app'} & set(sys.modules), "
        "threading.active_count())"
    )
    assert printed(program, tmp_path) == "set() 1"


def test_it_knows_no_dashboard(tmp_path: Path) -> None:
    (tmp_path / "app").mkdir()
    (tmp_path / "app" / "__init__.py").write_text("raise ImportError('somebody else’s')")
    program = (
        "import sys\n"
        "import hexapods as hx\n"
        "used = [getattr(hx, name) for name in dir(hx)]\n"
        "hx.race([hx.train(steps=5, simulator='kinematic')], steps=3)\n"
        "print({'app', 'fastapi', 'sqlalchemy', 'viser', 'distributed', 'matplotlib', 'scipy'}"
        " & set(sys.modules))"
    )
    assert printed(program, tmp_path) == "set()"


def test_looking_for_gymnasium_does_not_keep_it_from_being_registered(tmp_path: Path) -> None:
    program = (
        "import hexapods, importlib.util\n"
        "importlib.util.find_spec('gymnasium')\n"
        "import gymnasium\n"
        "print('RacingHexapods/Walk-v0' in gymnasium.registry, "
        "type(gymnasium.__loader__).__name__)"
    )
    assert printed(program, tmp_path) == "True SourceFileLoader"


@pytest.mark.parametrize("error", [hx.UnknownName("agent", "x", ["a", "b"]), hx.InvalidInput("no")])
def test_errors_are_pickled_as_pools_of_processes_do(error: hx.HexapodError) -> None:
    again = pickle.loads(pickle.dumps(error))
    assert (type(again), str(again)) == (type(error), str(error))


@pytest.mark.parametrize("first", ["gymnasium", "hexapods"])
def test_importing_it_registers_the_environment(tmp_path: Path, first: str) -> None:
    second = {"gymnasium": "hexapods", "hexapods": "gymnasium"}[first]
    program = (
        f"import {first}, {second}\n"
        "print(gymnasium.make('RacingHexapods/Walk-v0', simulator='kinematic').action_space)"
    )
    assert printed(program, tmp_path) == "Discrete(15)"


def test_an_unknown_name_is_answered_with_the_functions() -> None:
    with pytest.raises(AttributeError, match=r"no 'trian'; its functions: .* train, view$"):
        _ = hx.trian  # type: ignore[attr-defined]
    assert not hasattr(hx, "_anything")


def test_every_agent_is_there_by_its_class() -> None:
    assert {name for name in dir(hx) if getattr(hx, name) in OURS.values()} == {
        one.__name__ for one in OURS.values()
    }
    assert set(public.__all__) <= set(dir(hx))


def test_what_is_saved_is_loaded(tmp_path: Path) -> None:
    training = hx.train(steps=40, simulator="kinematic", evaluate_every=20)
    loaded = hx.load(training.save(tmp_path / "q.npz"))
    assert isinstance(loaded, hx.Training)
    assert (loaded.config, loaded.curve, loaded.result) == (
        training.config,
        training.curve,
        training.result,
    )
    race = hx.race([training, "greedy"], steps=4)
    again = hx.load(race.save(tmp_path / "race.npz"))
    assert isinstance(again, hx.Race)
    assert (again.config, again.standings) == (race.config, race.standings)


@pytest.mark.parametrize(
    ("content", "reason"),
    [(None, "cannot be read"), (b"PK", "neither a training nor a race"), ("npz", "not a Q-table")],
)
def test_a_file_of_something_else_is_refused(
    tmp_path: Path, content: bytes | str | None, reason: str
) -> None:
    path = tmp_path / "what.npz"
    if content == "npz":
        np.savez(path, x=np.zeros(3))
    elif isinstance(content, bytes):
        path.write_bytes(content)
    with pytest.raises(hx.HexapodError, match=reason):
        hx.load(path)
