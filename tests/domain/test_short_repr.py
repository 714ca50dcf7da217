"""Results and configs are told in a few hundred characters, in a notebook too."""

from collections.abc import Mapping
from dataclasses import is_dataclass
from typing import Any

import numpy as np
import pytest

import hexapods as hx
from hexapods.domain.creatures import CREATURES
from hexapods.domain.disturbances import KINDS
from hexapods.domain.model_robot import model_robot
from hexapods.domain.short_repr import MAX_REPR
from hexapods.experiments.config import ExperimentConfig
from hexapods.runs.config import TrainingConfig
from tests.model_robots import model_of

QUICK: dict[str, Any] = {"simulator": "kinematic", "steps": 5}


@pytest.fixture(scope="module")
def examples() -> Mapping[str, object]:
    """Return objects that the library returns and takes, as large as they usually are."""
    practice = hx.iter_train(record=True, evaluate_every=5, robot={"n_legs": 8}, **QUICK)
    records = list(practice)
    training = practice.training
    lanes = [hx.lane(training), *map(hx.lane, ["wave", "random-walk"] * 2)]
    race = hx.race(lanes, **QUICK)
    return {
        **{f"record {number}": record for number, record in enumerate(records)},
        **{field: getattr(training, field) for field in ("config", "table", "result", "curve")},
        "action values": hx.ActionValues(np.zeros((6, 9)), np.zeros((6, 9))),
        "training": training,
        "practice": practice,
        "race": race,
        "its config": race.config,
        "its result": race.result,
        "its lane": lanes[0],
        "its recording": race.recording[1],
        "its step": race.recording[0].steps[3],
        "its motion": race.recording[0].steps[3].motion,
        "its table": race.step_table(),
        "a figure": race.result.lanes[0],
        "view": hx.view(race),
        "policy": hx.policy(print),
        "benchmark": hx.benchmark("wave", tasks=("tripod",), seeds=1, workers=1),
        "world": hx.World([hx.Limp(legs=[leg], at_step=leg) for leg in range(1, 7)]),
        "gait": hx.Gait(1, 2, groups=((1, 3, 5), (2, 4, 6))),
        "leg": CREATURES["spider"].robot.legs[0],
        **{f"creature {name}": creature.robot for name, creature in CREATURES.items()},
        "a robot from a file": model_robot(model_of(hx.Robot()), "mine"),
    }


@pytest.fixture(scope="module")
def experiment() -> hx.Experiment:
    return hx.experiment(
        "sweep", gaits="left-right-origin", seeds=1, workers=1, agents=["greedy"], **QUICK
    )


def test_no_repr_is_longer_than_a_few_lines(
    examples: Mapping[str, object], experiment: hx.Experiment
) -> None:
    trial = next(iter(experiment.trials.values()))
    shown = {
        **examples,
        "experiment": experiment,
        "its config": experiment.config,
        "trial": trial,
        "its figure": experiment.figure(),
        "comparison": hx.compare([0.1, 0.2, 0.3], [0.2, 0.3, 0.4]),
    }
    assert {
        name: len(repr(value)) for name, value in shown.items() if len(repr(value)) > MAX_REPR
    } == {}
    covered = {type(value) for value in shown.values()}
    public = {value for name in dir(hx) if is_dataclass(value := getattr(hx, name))}
    without = {hx.Disturbance, *KINDS.values(), hx.Setting}
    assert public - without <= covered  # a new class has an example here


def test_it_tells_what_differs_from_the_defaults() -> None:
    assert repr(hx.Robot()) == "Robot(name='stiff')"
    assert repr(hx.Robot(femur_m=0.081)) == "Robot(name='stiff', femur_m=0.081)"
    assert repr(TrainingConfig(gait="left-right-origin", seed=3)) == "TrainingConfig(seed=3)"
    assert repr(TrainingConfig(gait="tripod")) == "TrainingConfig(gait='tripod')"
    assert "seeds=7" in repr(ExperimentConfig(experiment="sweep", seeds=7))
    assert repr(hx.World([hx.Limp(legs=[1])])).startswith("World(disturbances=(Limp(")
