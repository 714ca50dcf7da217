"""Judging an entry on a draw: deterministic, and a failure is a result."""

import pickle
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from hexapods.agents import registry
from hexapods.domain.errors import InvalidInput, TableMismatch
from hexapods.domain.robot import PRESETS, robot
from hexapods.domain.settings import SettingValues
from hexapods.domain.world import named_world
from hexapods.experiments.trial import TrialConfig, run_trial
from hexapods.tournaments.entry import EntryConfig, training_of
from hexapods.tournaments.judging import Judgement, judge
from hexapods.tournaments.rules import Draw
from hexapods.tournaments.tournament_file import sha256_of
from tests.quick_robot import HASTY
from tests.tournaments.sample_tournaments import rules_of, table_file, table_of

DRAW = Draw(5, "flat")


@pytest.fixture
def clumsy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Install a package with agents that fail: one raises, another takes no legal action."""
    about = tmp_path / "clumsy-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: clumsy\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text(
        "[hexapods.agents]\n"
        "clumsy = tests.own_agents:Clumsy\n"
        "cheat = tests.own_agents:Cheat\n"
        "seer = tests.tournaments.test_judging:Seer\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    registry.registered.cache_clear()
    yield
    registry.registered.cache_clear()


class Seer:
    """Learns, and plans with a simulator."""

    def __init__(self, expand: object) -> None:
        del expand


IN_MUJOCO = rules_of(
    simulator="mujoco",
    gait="tripod",
    robot=HASTY,
    steps=20,
    tolerance=0.03,
    worlds=("flat", "ice"),
)
AGENTS = ("q-learning", "linear-model", "greedy", "random-walk")
TWO_DRAWS = (Draw(5, "flat"), Draw(2**53 - 1, "ice"))


@pytest.fixture(scope="module")
def elsewhere() -> dict[str, Judgement]:
    """Return the judgement of each agent on the second draw, made by another process."""
    script = (
        "import pickle, sys; from hexapods.tournaments.judging import judge; "
        "given = pickle.load(sys.stdin.buffer); "
        "sys.stdout.buffer.write(pickle.dumps([judge(*one) for one in given]))"
    )
    arguments = [(IN_MUJOCO, EntryConfig(agent=agent), TWO_DRAWS[1]) for agent in AGENTS]
    done = subprocess.run(
        [sys.executable, "-c", script],
        input=pickle.dumps(arguments),
        capture_output=True,
        check=True,
    )
    return dict(zip(AGENTS, pickle.loads(done.stdout), strict=True))


@pytest.mark.promises
@pytest.mark.parametrize("agent", AGENTS)
def test_a_judgement_depends_on_neither_order_nor_thread_nor_process(
    elsewhere: dict[str, Judgement], agent: str
) -> None:
    rules, entry, draws = IN_MUJOCO, EntryConfig(agent=agent), TWO_DRAWS
    expected = [judge(rules, entry, draw) for draw in draws]
    assert [judge(rules, entry, draw) for draw in draws[::-1]] == expected[::-1]
    with ThreadPoolExecutor(2) as threads:
        assert list(threads.map(lambda draw: judge(rules, entry, draw), draws)) == expected
    assert elsewhere[agent] == expected[1]
    assert all(judgement.failure is None for judgement in expected)


def test_a_learner_practises_and_walks_from_rest_as_in_a_trial() -> None:
    rules = rules_of(steps=50)
    training = replace(training_of(EntryConfig(agent="q-learning"), rules), seed=5)
    [distance_m] = run_trial(TrialConfig(training=training)).distances_m
    assert judge(rules, EntryConfig(agent="q-learning"), DRAW) == Judgement(distance_m)
    less = judge(rules, EntryConfig(agent="q-learning", steps=10), DRAW)
    assert less != judge(rules, EntryConfig(agent="q-learning"), DRAW)


def test_what_learns_in_races_by_default_does_here() -> None:
    rules = rules_of(simulator="mujoco", steps=5)
    entry = EntryConfig(agent="linear-model")
    training = replace(training_of(entry, rules), seed=5)
    [goes_on], [stops] = (
        run_trial(TrialConfig(training=training, keep_learning=keeps)).distances_m
        for keeps in (True, False)
    )
    assert judge(rules, entry, DRAW).distance_m == goes_on != stops


@pytest.mark.promises
def test_the_world_and_the_tolerance_of_the_draw_hold() -> None:
    hasty: dict[str, Any] = {"simulator": "mujoco", "gait": "tripod", "robot": HASTY, "steps": 5}
    rules = rules_of(**hasty, worlds=("flat", "ice"))
    entry = EntryConfig(agent="greedy")
    flat, ice = (judge(rules, entry, Draw(5, world)).distance_m for world in ("flat", "ice"))
    assert ice < flat
    built = rules_of(**hasty, tolerance=0.1)
    assert judge(built, entry, DRAW) != judge(built, entry, Draw(6, "flat"))
    assert judge(built, entry, DRAW) != judge(rules, entry, DRAW)


def test_a_search_plans_with_the_nominal_model() -> None:
    rules = rules_of(simulator="mujoco", robot=HASTY, steps=5, worlds=("limp-pair",))
    training = replace(
        training_of(EntryConfig(agent="greedy"), rules), seed=5, world=named_world("limp-pair")
    )
    informed, nominal = (
        run_trial(TrialConfig(training=training, blocks=0, plans_with=model)).distances_m[0]
        for model in ("start", "nominal")
    )
    assert judge(rules, EntryConfig(agent="greedy"), Draw(5, "limp-pair")).distance_m == nominal
    assert nominal < informed


def test_a_table_walks_as_if_it_had_been_learned_on_the_draw() -> None:
    rules, draw = rules_of(tables=True), Draw(0, "flat")  # it was learned with the seed 0
    entry = EntryConfig(agent="q-learning", table=sha256_of(table_file()))
    practised = judge(rules, EntryConfig(agent="q-learning", steps=40), draw)
    assert judge(rules, entry, draw, table_of()) == practised


def test_a_table_of_another_robot_and_simulator_may_race() -> None:
    rules = rules_of(simulator="mujoco", robot=PRESETS["compliant"], tables=True)
    entry = EntryConfig(agent="q-learning", table=sha256_of(table_file()))
    assert judge(rules, entry, DRAW, table_of()).failure is None


def test_a_table_that_does_not_fit_is_refused() -> None:
    entry = EntryConfig(agent="q-learning", table=sha256_of(table_file()))
    with pytest.raises(TableMismatch, match="divisions"):
        judge(rules_of(tables=True, divisions=3), entry, DRAW, table_of())
    with pytest.raises(InvalidInput, match="with its table"):
        judge(rules_of(tables=True), entry, DRAW)
    with pytest.raises(InvalidInput, match="with its table"):
        judge(rules_of(tables=True), EntryConfig(agent="q-learning"), DRAW, table_of())


@pytest.mark.parametrize("agent", ["q-learning", "greedy", "random-walk"])
def test_diverged_physics_is_a_failure(agent: str) -> None:
    light = dict.fromkeys(("coxa_kg", "femur_kg", "tibia_kg", "foot_kg"), 0.001)
    stiff = {"servo_kp": 1000, "servo_kv": 100, "servo_torque_nm": 100}
    free = {"joint_armature": 0.0001, "joint_damping": 0.0001, "dt_s": 0.005}
    rules = rules_of(simulator="mujoco", steps=20, robot=robot({**light, **stiff, **free}))
    judgement = judge(rules, EntryConfig(agent=agent), Draw(3, "flat"))
    assert judgement.distance_m == 0.0
    assert judgement.failure is not None
    assert "the physics diverged at step" in judgement.failure


@pytest.mark.usefixtures("clumsy")
@pytest.mark.parametrize(("agent", "reason"), [("clumsy", "I tripped"), ("cheat", "action")])
def test_an_agent_that_fails_is_a_failure(agent: str, reason: str) -> None:
    judgement = judge(rules_of(), EntryConfig(agent=agent), DRAW)
    assert judgement.distance_m == 0.0
    assert judgement.failure is not None
    assert reason in judgement.failure


@pytest.mark.usefixtures("clumsy")
def test_an_agent_that_would_practise_with_a_model_of_the_secret_world_is_refused() -> None:
    with pytest.raises(InvalidInput, match="learns and plans with a simulator"):
        judge(rules_of(), EntryConfig(agent="seer"), DRAW)


@pytest.mark.promises
def test_a_search_that_simulates_too_many_transitions_has_failed() -> None:
    two_steps = EntryConfig(agent="look-ahead", settings=SettingValues({"depth": 2}))
    assert judge(rules_of(), two_steps, DRAW).failure is None
    three_steps = EntryConfig(agent="look-ahead", settings=SettingValues({"depth": 3}))
    judged = judge(rules_of(), three_steps, DRAW)
    assert judged.failure is not None
    assert "over 40,000 transitions" in judged.failure
    assert judge(rules_of(transitions=100_000), three_steps, DRAW).failure is None
    fewer = judge(rules_of(transitions=7_799), two_steps, DRAW)
    assert fewer.failure is not None
    assert "over 7,799 transitions" in fewer.failure
    assert judge(rules_of(transitions=7_799), two_steps, DRAW) == fewer
    assert judge(rules_of(transitions=7_800), two_steps, DRAW).failure is None


def test_the_fewest_transitions_of_rules_are_enough_for_greedy() -> None:
    for options, fewest in (({}, 600), ({"divisions": 3}, 1_200)):
        rules = rules_of(transitions=fewest, **options)
        assert judge(rules, EntryConfig(agent="greedy"), DRAW).failure is None


def test_a_judgement_is_a_number_and_0_where_it_failed() -> None:
    with pytest.raises(InvalidInput, match="finite"):
        Judgement(float("nan"))
    with pytest.raises(InvalidInput, match="must be 0"):
        Judgement(0.1, "it fell")
