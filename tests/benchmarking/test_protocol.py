"""The frozen protocol, and the bodies and damages that a seed draws."""

import hashlib
from pathlib import Path

import numpy as np
import pytest

from hexapods.benchmarking import protocol as protocols
from hexapods.benchmarking.draws import drawn_body, drawn_damage
from hexapods.benchmarking.protocol import protocol, tasks_of
from hexapods.domain.errors import UnknownName
from hexapods.domain.gait import PAPER_GAITS, resolve
from hexapods.domain.grid import FootGrid
from hexapods.domain.kinematics import check_reach
from hexapods.domain.model_robot import ModelRobot
from hexapods.domain.support import Support
from hexapods.imports.child import read_robot_file
from hexapods.runs.config import WalkingProblem

FOLDER = Path(protocols.__file__).parent
HEXABENCH_1 = protocol("hexabench-1")


@pytest.mark.parametrize(
    ("file", "digest"),
    [
        ("hexabench_1.json", "f5b7bb96b17914d1f6f17ade90ee9d2ec970dc90b317756813bf93d3f804864c"),
        ("mantis.json", "b5a88f86992000e8323d52172886cc7ac5804ca341a3930af862b32dc8ff1256"),
    ],
)
def test_the_protocol_is_frozen(file: str, digest: str) -> None:
    """Scores of one name can be compared: another task or number is another protocol."""
    assert hashlib.sha256((FOLDER / file).read_bytes()).hexdigest() == digest


def test_it_has_the_tasks_that_it_promises() -> None:
    assert len(HEXABENCH_1.tasks) >= 12
    assert set(PAPER_GAITS) <= set(HEXABENCH_1.tasks)
    assert {"tripod", "ice", "compliant", "limp", "lost", "stuck"} < set(HEXABENCH_1.tasks)
    assert HEXABENCH_1.budgets == (50, 100, 250, 500, 1000)
    for task in HEXABENCH_1.tasks.values():
        assert task.best_known.distance_m > 0.1, task.name
        assert task.best_known.found_by


@pytest.mark.parametrize("name", HEXABENCH_1.tasks)
def test_every_robot_reaches_its_grid(name: str) -> None:
    walk = HEXABENCH_1.tasks[name].walk(seed=0, tolerance=0.03)
    check_reach(walk.robot, walk.resolved_gait, walk.grid)
    assert walk.tolerance == 0.03
    assert walk.simulator == "mujoco"


def test_one_body_tips_and_one_robot_is_from_a_file() -> None:
    tipping, imported = (HEXABENCH_1.tasks[name].walk(0, 0.0) for name in ("tipping", "imported"))
    assert least_margin_m(tipping) < -0.1
    assert isinstance(imported.robot, ModelRobot)


def test_the_robot_from_a_file_is_what_was_imported() -> None:
    """The document was made of `mantis.xml`: but for what is drawn, and so for the meshes."""
    read = read_robot_file((FOLDER / "mantis.xml").read_bytes(), "mantis.xml")
    robot = HEXABENCH_1.tasks["imported"].walk(0, 0.0).robot
    assert isinstance(robot, ModelRobot)
    assert [link.name for link in robot.model.links] == [link.name for link in read.model.links]
    assert [link.mass_kg for link in robot.model.links] == pytest.approx(
        [link.mass_kg for link in read.model.links]
    )


def test_a_seed_draws_the_same_and_another_one_something_else() -> None:
    for name in ("drawn-body", "drawn-damage"):
        task = HEXABENCH_1.tasks[name]
        walks = [task.walk(seed, 0.0) for seed in range(4)]
        assert walks[0] == task.walk(0, 0.0)
        assert all(walk != walks[0] for walk in walks[1:]), name


@pytest.mark.parametrize("seed", range(8))
def test_drawn_bodies_stand_on_six_to_eight_legs_and_reach_the_grid(seed: int) -> None:
    robot, gait = drawn_body(np.random.default_rng(seed))
    assert 6 <= len(robot.legs) <= 8
    walk = WalkingProblem(robot=robot, gait=gait)
    assert len(walk.resolved_gait.groups) == 3
    check_reach(robot, walk.resolved_gait, FootGrid())
    assert least_margin_m(walk) > 0


def test_drawn_damages_are_of_every_kind_and_in_every_gait_of_the_paper() -> None:
    rng = np.random.default_rng(0)
    drawn = [drawn_damage(rng) for _ in range(60)]
    kinds = {world.disturbances[0].kind for world, _ in drawn}
    assert kinds == {"limp", "lost", "weak", "stuck"}
    assert {gait for _, gait in drawn} == set(PAPER_GAITS)
    for world, gait in drawn:
        WalkingProblem(gait=gait, world=world)  # it can happen to the hexapod


def test_an_unknown_protocol_or_task_is_refused_with_the_valid_names() -> None:
    with pytest.raises(UnknownName, match="protocol 'hexabench-2'; choose one of: hexabench-1"):
        protocol("hexabench-2")
    with pytest.raises(UnknownName, match="'moon'; choose one of: left-right-origin, left-"):
        tasks_of(HEXABENCH_1, ["tripod", "moon"])


def least_margin_m(walk: WalkingProblem) -> float:
    gait = resolve(walk.gait, walk.robot.azimuths_deg)
    return Support(walk.robot, gait).least_margin_m(gait.groups)
