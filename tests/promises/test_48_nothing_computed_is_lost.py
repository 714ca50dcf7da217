"""Promise 48: nothing computed is lost to its description.

Robots of odd names, robots that overrides of a preset cannot say, numbers that no file may have:
each is refused before anything is computed, or what was computed can be saved and read again. In
full: on MuJoCo.
"""

import string
from pathlib import Path
from typing import Any

import pytest

import hexapods as hx
from hexapods.domain.body import NO_NUMBERS
from hexapods.domain.robot import PRESETS, document_of
from hexapods.domain.text import MAX_NAME
from hexapods.experiments.report.page import page
from hexapods.experiments.report.trials_csv import trials_csv
from tests.promises.length import at_length

pytestmark = pytest.mark.test

QUICK: dict[str, Any] = {
    "simulator": at_length("kinematic", "mujoco"),
    "steps": 3,
    "evaluate_every": 0,
}
NAMES = (
    "x",
    "",
    "my 🤖\nrobot\N{NO-BREAK SPACE}2",
    "\0\udcff\N{RIGHT-TO-LEFT OVERRIDE}",
    "stiff (modified) (modified)",
    "x" * 5_000,
    *PRESETS,
)
NUMBERS = [name for name in vars(hx.Robot()) if name not in NO_NUMBERS]


def refused_or_kept(robot: hx.Robot, folder: Path) -> bool:
    """Train with a robot and race it: False if both are refused before a step is taken.

    Else both must be saved and read again, with the same robot.
    """
    taken: list[object] = []
    try:
        training = hx.train(robot=robot, on_record=taken.append, **QUICK)
    except hx.InvalidInput:
        assert not taken, "what was practised is lost"
        with pytest.raises(hx.InvalidInput):
            hx.race(["wave"], robot=robot, steps=2, on_step=lambda: taken.append(1))
        assert not taken, "what was raced is lost"
        return False
    saved = hx.load(training.save(folder / "q.npz"))
    assert isinstance(saved, hx.Training)
    assert saved.config == training.config
    assert saved.q_table_sha256 == training.q_table_sha256
    race = hx.race([training, "wave"], robot=robot, steps=2)
    read = hx.load(race.save(folder / "race.npz"))
    assert isinstance(read, hx.Race)
    assert (read.config, read.recording_sha256) == (race.config, race.recording_sha256)
    assert repr(training), repr(race)
    return True


@pytest.mark.parametrize("name", NAMES, ids=lambda name: ascii(name)[:20])
def test_a_robot_of_any_name_is_trained_raced_and_saved(name: str, tmp_path: Path) -> None:
    assert refused_or_kept(hx.Robot(name=name), tmp_path)
    assert refused_or_kept(hx.Robot(name=name, femur_m=0.081), tmp_path)


@pytest.mark.parametrize("number", NUMBERS)
def test_a_number_that_no_file_may_have_is_refused_before_the_practice(
    number: str, tmp_path: Path
) -> None:
    usual = getattr(hx.Robot(), number) or 0.2
    pairs = {"torso_length_m": "torso_width_m", "torso_width_m": "torso_length_m"}
    for factor in (1e-5, 1.01, 1e4):
        numbers = (number, pairs.get(number, number))
        values: dict[str, Any] = dict.fromkeys(numbers, factor * usual)
        try:
            robot = hx.Robot(**values)
        except hx.InvalidInput:
            continue
        refused_or_kept(robot, tmp_path)


def test_a_stored_robot_of_any_name_is_refused_or_kept(tmp_path: Path) -> None:
    document = tmp_path / "robot.json"
    document.write_bytes(document_of(hx.Robot(femur_m=0.082)))
    for name in NAMES:
        if len(name) > MAX_NAME:
            with pytest.raises(hx.InvalidInput, match="at most 100 characters"):
                hx.load_robot(document, name)
        else:
            assert refused_or_kept(hx.load_robot(document, name), tmp_path)
    long = document.rename(tmp_path / f"{string.ascii_lowercase * 6}.json")
    assert refused_or_kept(hx.load_robot(long), tmp_path)


def test_an_experiment_of_robots_of_any_name_has_its_report(tmp_path: Path) -> None:
    robots = [hx.Robot(name=name, femur_m=0.08 + n / 1000) for n, name in enumerate(NAMES[1:4])]
    done = hx.experiment(
        "sweep",
        folder=tmp_path / "kept",
        robots=robots,
        gaits="left-right-origin",
        simulator="kinematic",
        agents="wave",
        seeds=1,
        steps=5,
        workers=1,
    )
    assert not done.summary["trials"]["set_aside"]
    assert len(done.settings) == 2 * len(robots)
    assert page(done.summary).encode()
    assert trials_csv(done.config, done.trials, {})
    assert done._repr_html_().encode()
    assert repr(done).encode()
