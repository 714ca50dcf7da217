"""`import hexapods as hx`: its names, what importing it costs, and what it never imports."""

import inspect
import pickle
import pydoc
import subprocess
import sys
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path
from typing import Any, Unpack

import numpy as np
import pytest

import hexapods as hx
from hexapods.agents.registry import BUILT_IN
from hexapods.arguments import WALK, Walk
from hexapods.domain.disturbances import KINDS
from hexapods.environment import WalkEnv
from hexapods.experiments.config import ExperimentConfig
from hexapods.runs.config import TrainingConfig, WalkingProblem
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import RaceConfig


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


def test_importing_it_changes_no_other_import(tmp_path: Path) -> None:
    program = (
        "import sys\n"
        "before = list(sys.meta_path)\n"
        "import hexapods\n"
        "hexapods.train, dir(hexapods)\n"
        "print(sys.meta_path == before)"
    )
    assert printed(program, tmp_path) == "True"


@pytest.mark.parametrize("error", [hx.UnknownName("agent", "x", ["a", "b"]), hx.InvalidInput("no")])
def test_errors_are_pickled_as_pools_of_processes_do(error: hx.HexapodError) -> None:
    again = pickle.loads(pickle.dumps(error))
    assert (type(again), str(again)) == (type(error), str(error))


def test_an_unknown_name_is_answered_with_the_functions() -> None:
    with pytest.raises(AttributeError, match=r"no 'trian'; its functions: .* train, view$"):
        _ = hx.trian  # type: ignore[attr-defined]
    assert not hasattr(hx, "_anything")


def test_every_agent_is_there_by_its_class() -> None:
    assert {name for name in dir(hx) if getattr(hx, name) in BUILT_IN.values()} == {
        agent_class.__name__ for agent_class in BUILT_IN.values()
    }


def test_only_the_public_names_are_seen() -> None:
    offered: list[str] = hx.__all__  # type: ignore[attr-defined]  # which is there when asked for
    assert dir(hx) == sorted(["__version__", *offered])
    imported: dict[str, Any] = {}
    exec("from hexapods import *", imported)
    assert imported.keys() - {"__builtins__"} == set(offered)


def test_errors_and_records_and_disturbances_are_there() -> None:
    errors = {name for name in dir(hx) if _is_class(name, hx.HexapodError)}
    assert errors > {"TableMismatch", "Diverged", "ClusterLost", "TooLong", "ResultNotStored"}
    assert {name for name in dir(hx) if _is_class(name, hx.Disturbance)} == {
        "Disturbance",
        *(kind.__name__ for kind in KINDS.values()),
    }
    steps = hx.iter_train(steps=1, simulator="kinematic")
    assert {type(step) for step in steps} <= {getattr(hx, name) for name in dir(hx)}


def _is_class(name: str, base: type) -> bool:
    value = getattr(hx, name)
    return isinstance(value, type) and issubclass(value, base)


def test_help_describes_the_public_names_and_nothing_else() -> None:
    text = pydoc.plain(pydoc.render_doc(hx))
    assert "train(agent" in text
    assert "import_module" not in text


@pytest.mark.parametrize(
    ("function", "config", "without"),
    [
        (hx.train, TrainingConfig, {"agent", "pace", "settings"}),
        (hx.iter_train, TrainingConfig, {"agent", "pace", "settings"}),
        (hx.evaluate, TrainingConfig, {"agent", "pace", "settings"}),
        (hx.race, RaceConfig, {"lanes", "branch_from"}),
        (hx.lane, LaneConfig, {"agent", "settings"}),
        (hx.experiment, ExperimentConfig, {"experiment", "settings", "blocks"}),
    ],
)
def test_signatures_have_all_fields_of_the_configs(
    function: Callable[..., object], config: Any, without: set[str]
) -> None:
    parameters = inspect.signature(function).parameters.values()
    named = {parameter.name for parameter in parameters if parameter.kind is parameter.KEYWORD_ONLY}
    if any(parameter.annotation == Unpack[Walk] for parameter in parameters):
        named |= set(WALK)
    no_fields = {
        *("table", "changes", "checkpoint", "on_record", "record", "on_step"),
        *("folder", "workers", "on_trial"),
    }
    assert named - no_fields == {field.name for field in fields(config)} - without


def test_the_keywords_of_a_walking_problem_are_its_fields() -> None:
    assert [field.name for field in fields(WalkingProblem)] == list(WALK)


@pytest.mark.parametrize("function", [hx.train, hx.race, WalkEnv.__init__])
def test_help_names_the_keywords_of_a_walking_problem(function: Callable[..., object]) -> None:
    text = inspect.getdoc(function) or ""
    assert [name for name in WALK if name not in text] == []


def test_type_checkers_know_the_arguments() -> None:
    # mypy, which reads this file, reports an ignore that is not needed.
    for call in (
        lambda: hx.train(steps="5"),  # type: ignore[arg-type]
        lambda: hx.evaluate("greedy", divisions="2"),  # type: ignore[arg-type]
        lambda: hx.race(["greedy"], alhpa=0.1),  # type: ignore[call-arg]
        lambda: hx.experiment("sweep", seeds=[3]),  # type: ignore[arg-type]
        lambda: hx.iter_train(world=3, alpha=0.1),  # type: ignore[arg-type]
        lambda: hx.race(["greedy"], divisions="2"),  # type: ignore[arg-type]
        lambda: WalkEnv(gait=3),  # type: ignore[arg-type]
        lambda: WalkEnv(griat="left-right-origin"),  # type: ignore[call-arg]
    ):
        with pytest.raises(hx.InvalidInput):
            call()


def test_a_saved_training_is_loaded(tmp_path: Path) -> None:
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
    assert again.recording_sha256 == race.recording_sha256


def test_a_race_that_was_changed_is_refused(tmp_path: Path) -> None:
    path = hx.race(["greedy"], steps=2, simulator="kinematic").save(tmp_path / "race.npz")
    with np.load(path) as file:
        arrays = {**file, "lane0.scalars": file["lane0.scalars"] + 1}
    np.savez(path, **arrays)
    with pytest.raises(hx.DamagedFile, match="do not match its checksum"):
        hx.load(path)
    del arrays["digest"]
    np.savez(path, **arrays)
    with pytest.raises(hx.DamagedFile, match="is not a race that was saved"):
        hx.load(path)


@pytest.mark.parametrize("path", [3, "", "a\0", b"q.npz", None])
def test_an_invalid_path_is_refused(path: Any) -> None:
    race = hx.race(["greedy"], steps=1, simulator="kinematic")
    for use in (hx.load, race.save, hx.View("", "", b"", "").save):
        with pytest.raises(hx.InvalidInput, match=r"given by its path, a text or a Path, not by"):
            use(path)


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


def test_a_recommended_learner_is_one_to_train_with() -> None:
    """By default in the gait that suits the robot; what is not valid is refused by name."""
    assert hx.recommended_agent("dog") == hx.recommended_agent() == "linear-model"
    assert hx.recommended_agent({"n_legs": 3}) == hx.recommended_agent("dog", "bound")
    agent = hx.recommended_agent("dog", "bound")
    training = hx.train(agent, robot="dog", gait="bound", steps=5, simulator="kinematic")
    assert training.config.agent == "multilevel-model"
    with pytest.raises(hx.InvalidInput, match="stiff or compliant"):
        hx.recommended_agent(4)  # type: ignore[arg-type]
    with pytest.raises(hx.UnknownName, match="bound"):
        hx.recommended_agent("dog", "hop")
