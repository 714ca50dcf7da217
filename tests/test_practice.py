"""`hx.train`, `hx.iter_train` and `hx.evaluate`: the training loop in one call."""

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import hexapods as hx
from hexapods.arguments import plain, read_walk
from hexapods.assembly import build_learner
from hexapods.domain.disturbances import Limp
from hexapods.domain.errors import TableMismatch
from hexapods.domain.robot import robot
from hexapods.runs.config import training_config
from hexapods.runs.records import Evaluated, StepTaken
from hexapods.runs.results import training_result
from hexapods.runs.training import train
from tests.own_agents import Restless

QUICK: dict[str, Any] = {"simulator": "kinematic", "steps": 60}


def test_it_is_the_training_of_the_loop() -> None:
    config = training_config(gait="left-right-vertical", seed=7, alpha=0.2, **QUICK)
    learner = build_learner(config)
    for _ in train(learner, config):
        pass

    done = hx.train("q-learning", gait="left-right-vertical", seed=7, alpha=0.2, **QUICK)

    assert done.config == config
    assert done.result == training_result(learner, config)
    assert done.distance_m == done.curve[-1].distance_m
    assert [point.step for point in done.curve] == [50, 60]


def test_agents_are_given_by_name_or_class() -> None:
    by_name, by_class = hx.train("sarsa", **QUICK), hx.train(hx.Sarsa, **QUICK)
    assert by_name.q_table_sha256 == by_class.q_table_sha256
    assert hx.train(Restless, **QUICK).config.agent == "tests.own_agents:Restless"
    assert hx.train(**QUICK).config.agent == "q-learning"


def test_worlds_robots_and_gaits_are_given_in_any_form() -> None:
    gait = {"right_leg": 1, "left_leg": 4, "symmetry": "origin"}
    plain = read_walk({"world": "limp-pair", "robot": "compliant", "gait": gait})
    built = read_walk(
        {
            "world": hx.World((Limp(legs=(1, 4)),)),
            "robot": robot("compliant"),
            "gait": hx.Gait(**gait),  # type: ignore[arg-type]
        }
    )
    assert plain == built
    for world in (["limp:legs=1,4"], [{"kind": "limp", "legs": [1, 4]}], [Limp(legs=(1, 4))]):
        assert read_walk({"world": world})["world"] == built["world"]


def test_records_come_as_they_happen() -> None:
    records = list(hx.iter_train("linear-model", record=True, evaluate_every=30, **QUICK))
    steps = [record for record in records if isinstance(record, StepTaken)]
    assert [step.step for step in steps] == list(range(1, 61))
    assert steps[0].motion is not None
    seen: list[object] = []
    done = hx.train("linear-model", evaluate_every=30, on_record=seen.append, **QUICK)
    assert len(seen) == len(records)
    evaluations = [record.distance_m for record in records if isinstance(record, Evaluated)]
    assert [point.distance_m for point in done.curve] == evaluations


def test_the_training_so_far_is_available_at_any_moment() -> None:
    practice, whole = (
        hx.iter_train(evaluate_every=20, **QUICK),
        hx.train(evaluate_every=20, **QUICK),
    )
    for record in practice:
        if isinstance(record, StepTaken) and record.step == 30:
            break
    half = practice.training
    assert (half.table.meta["step"], [point.step for point in half.curve]) == (30, [20])
    assert hx.evaluate(half) == half.distance_m
    assert "30 of 60 steps" in repr(practice)
    list(practice)
    assert practice.training.result == whole.result
    assert practice.training.curve == whole.curve
    assert half.q_table_sha256 != whole.q_table_sha256


def test_an_invalid_argument_raises_at_the_call_and_not_at_the_first_record() -> None:
    with pytest.raises(hx.UnknownName):
        hx.iter_train("q-lerning")


def test_it_goes_on_from_a_table(tmp_path: Path) -> None:
    first = hx.train(gait="front-back-origin", divisions=3, grid_side_m=0.03, seed=3, **QUICK)
    second = hx.train(table=first, **QUICK)
    assert second.config.gait == "front-back-origin"
    assert second.config.divisions == 3
    assert second.q_table_sha256 != first.q_table_sha256
    from_file = hx.train(table=first.save(tmp_path / "q.npz"), **QUICK)
    assert from_file.q_table_sha256 == second.q_table_sha256
    with pytest.raises(TableMismatch, match="divisions 3"):
        hx.train(table=first, divisions=2, **QUICK)


def test_changes_happen_while_it_practises() -> None:
    noise = {"kind": "sensor-noise", "sd_m": 0.01}
    changes: list[dict[str, Any]] = [
        {"step": 20, "settings": {"alpha": 0.1}},
        {"step": 30, "disturbance": noise},
    ]
    disturbed = hx.train(changes=changes, **QUICK)
    assert disturbed.table.meta["disturbances"][0]["at_step"] == 31
    assert disturbed.q_table_sha256 != hx.train(changes=changes[:1], **QUICK).q_table_sha256


@pytest.mark.parametrize(
    ("agent", "changes", "reason"),
    [
        ("q-learning", [{"step": 1, "alhpa": 0.1}], "unknown argument of a change .*'alhpa'"),
        ("q-learning", [{"step": 1, "pace": 2}], "unknown argument of a change .*'pace'"),
        ("q-learning", [{"step": 1, "settings": {"alpha": 3}}], "alpha"),
        ("q-learning", [{"step": 61, "settings": {"alpha": 0.1}}], "from 0 to 60, not 61"),
        ("q-learning", [{"step": 9}, {"step": 2, "settings": {"alpha": 0.2}}], "from 9 to 60"),
        ("q-learning", [{"settings": {"alpha": 0.1}}], 'a mapping such as {"step": 20'),
        ("wave", [{"step": 1, "settings": {"alpha": 0.1}}], "wave has no settings that change"),
        (
            "q-learning",
            None,
            r'changes is a list, such as \[{"step": 20, "settings": {"alpha": 0.1}}\], not None',
        ),
        ("q-learning", {"step": 1, "settings": {"alpha": 0.1}}, "changes is a list"),
        ("q-learning", [{"step": 1, "disturbance": "ice"}], r'ice is a world and no .*"friction:'),
        ("wave", [{"step": 1, "disturbance": 3}], "a disturbance is such as .*, not 3"),
        ("wave", [{"step": 50, "disturbance": "limp:legs=1"}], "kinematic simulator knows no limp"),
    ],
)
def test_invalid_changes_are_refused(agent: str, changes: Any, reason: str) -> None:
    with pytest.raises(hx.HexapodError, match=reason):
        hx.train(agent, changes=changes, **QUICK)


def test_numbers_may_be_those_of_numpy() -> None:
    numbers: dict[str, Any] = {"seed": np.arange(4)[3], "alpha": np.float64(0.2)}
    assert hx.train(**QUICK, **numbers).config == hx.train(**QUICK, seed=3, alpha=0.2).config
    gait = {"right_leg": np.int64(1), "left_leg": 2, "pairs": np.array([[1, 4], [2, 5], [3, 6]])}
    nested = hx.train(gait=gait, robot={"n_legs": np.int64(6)}, **QUICK)
    assert nested.config.gait == hx.Gait(1, 2, pairs=((1, 4), (2, 5), (3, 6)))
    assert nested.to_bytes()
    world = [{"kind": "limp", "legs": np.array([1, 4])}]
    assert read_walk(plain({"world": world}))["world"] == hx.World((Limp(legs=(1, 4)),))


def test_an_evaluation_is_that_of_the_training() -> None:
    for agent in ("q-learning", "linear-model"):
        done = hx.train(agent, gait="left-right-vertical", **QUICK)
        assert hx.evaluate(done) == done.distance_m
    assert hx.evaluate(done, simulator="mujoco") != done.distance_m
    with pytest.raises(TableMismatch, match="divisions 2"):
        hx.evaluate(done, divisions=3)
    with pytest.raises(hx.InvalidInput, match="q-learning walks with what it has learned"):
        hx.evaluate("q-learning")
    assert hx.evaluate("greedy", simulator="kinematic") == done.greedy_distance_m


@pytest.mark.parametrize(
    ("agent", "other"),
    [("double-q", "q-learning"), ("q-learning", "double-q"), ("linear-model", "q-learning")],
)
def test_a_table_of_another_agent_is_refused(agent: str, other: str) -> None:
    table = hx.train(other, **QUICK)
    for use in (hx.train, hx.evaluate, hx.lane):
        with pytest.raises(TableMismatch, match=f"learned by {other}, not by {agent}"):
            use(agent, table=table)


def test_a_training_comes_with_what_it_has_learned() -> None:
    learned, other_training = hx.train(**QUICK), hx.train("sarsa", **QUICK)
    with pytest.raises(hx.InvalidInput, match=r"leave out table, .* by its name, 'q-learning'"):
        hx.evaluate(learned, table=other_training)


def test_an_agent_is_found_by_other_processes() -> None:
    class Local(hx.QLearning):
        pass

    for agent, reason in (
        (Local, "define the agent's class at the top level of a module"),
        (hx.Agent, "is there to be derived from"),
        (hx.TabularLearner, "is there to be derived from"),
        ("hexapods.agents.protocol:Agent", "is there to be derived from"),
    ):
        with pytest.raises(hx.InvalidInput, match=reason):
            hx.train(agent, **QUICK)


def test_its_agent_does_what_it_learned() -> None:
    greedy = hx.train("greedy", **QUICK)
    assert greedy.agent is not pickle.loads(pickle.dumps(greedy)).agent
    done = hx.train(**QUICK)
    assert done.agent.table.sha256() == done.q_table_sha256  # type: ignore[attr-defined]


def test_it_shows_itself() -> None:
    done = hx.train(**QUICK)
    assert repr(done) == f"<Training of q-learning: 60 steps, {done.distance_m:.2f} m>"
    assert f"<td>{done.distance_m:.2f} m</td>" in done._repr_html_()


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        ({"alhpa": 0.1}, "choose one of: gait, robot, .*steps, .*alpha"),
        ({"pace": 2}, "unknown argument of a training 'pace'"),
        ({"agent": 3}, "by its name or its class"),
        ({"agent": dict}, "lacks act"),
        ({"alpha": 2}, "alpha"),
        ({"world": "swamp"}, "unknown world 'swamp'"),
        ({"world": ["ice"]}, r'ice is a world .*: write world="ice", or \["friction:value=0.1'),
        ({"on_record": 3}, "on_record is a function that is called, not 3"),
        ({"gait": 3}, "gait is one of left-right-origin, .* or its legs, not 3"),
        ({"gait": {"right_leg": 1.5, "left_leg": 2, "symmetry": "origin"}}, "whole .* not 1.5"),
        ({"table": "a\0"}, "a table is given by its path"),
        ({"world": None}, "world is one of flat, .*, a list of disturbances or a World, not None"),
        ({"world": {"kind": "limp", "legs": [1]}}, "a list of disturbances"),
        ({"robot": 3}, "robot is stiff or .* a mapping or a Robot, not 3"),
        ({"gait": {"right": 1}}, "needs right_leg and left_leg, .*; not right"),
        ({"gait": {"right_leg": 1, "left_leg": 4, "pairs": 3}}, "must look like"),
        ({"table": 3}, "a training or the path of its file, not 3"),
        ({"world": ["sensor-noise:sd_m=0.01:until=900"]}, "until_step must be at most 60"),
        ({"table": "nothing.npz"}, "cannot read the table nothing.npz"),
    ],
)
def test_invalid_arguments_are_refused(arguments: dict[str, Any], reason: str) -> None:
    with pytest.raises(hx.HexapodError, match=reason):
        hx.train(**{**QUICK, **arguments})
