"""`hx.race` and `hx.lane`: the race loop in one call."""

from typing import Any

import pytest

import hexapods as hx
from hexapods.domain.errors import TableMismatch

QUICK: dict[str, Any] = {"simulator": "kinematic", "steps": 20}


@pytest.fixture(scope="module")
def training() -> hx.Training:
    return hx.train(gait="left-right-vertical", steps=100, simulator="kinematic")


def test_the_race_is_that_of_its_training(training: hx.Training) -> None:
    race = hx.race([training, "greedy", hx.lane("look-ahead", depth=1)], steps=20)
    assert (race.config.gait, race.config.simulator) == ("left-right-vertical", "kinematic")
    assert [lane.agent for lane in race.config.lanes] == ["q-learning", "greedy", "look-ahead"]
    ranks = [standing.rank for standing in race.standings]
    assert ranks == sorted(ranks)  # type: ignore[type-var]
    assert {standing.lane for standing in race.standings} == {0, 1, 2}
    assert all(len(lane.steps) == 20 for lane in race.recording)
    assert race.standings_under("wall") != race.standings
    assert repr(race).startswith("<Race over 20 steps: ")
    assert "<td>greedy</td>" in race._repr_html_()


def test_a_race_repeats_with_the_same_seed(training: hx.Training) -> None:
    lanes: list[Any] = [training, hx.lane("sarsa", keep_learning=True), hx.RandomWalk]
    first, second = (hx.race(lanes, seed=5, **QUICK) for _ in range(2))
    assert [s.total_distance_m for s in first.standings] == [
        s.total_distance_m for s in second.standings
    ]


def test_its_hash_is_of_all_that_repeats(training: hx.Training) -> None:
    lanes: list[Any] = [training, hx.lane("look-ahead", depth=1), hx.lane("linear-model")]
    first, second = (hx.race(lanes, seed=5, **QUICK) for _ in range(2))
    assert first.result != second.result  # the times of decisions
    assert first.recording_sha256 == second.recording_sha256
    for change in ({"seed": 6}, {"robot": {"femur_m": 0.081}}, {"steps": 19}):
        changed = hx.race(lanes, **{**QUICK, "seed": 5, **change})
        assert changed.recording_sha256 != first.recording_sha256


def test_the_world_is_not_that_of_the_practice() -> None:
    noisy = hx.train(world="noise", **QUICK)
    assert not hx.race([noisy], steps=2).config.world
    assert hx.race([noisy], world="noise", steps=2).config.world


def test_on_step_is_called_for_each_step_of_each_lane() -> None:
    calls: list[None] = []
    hx.race(["greedy", "wave"], on_step=lambda: calls.append(None), **QUICK)
    assert len(calls) == 40


def test_a_race_in_which_all_fail_has_no_ranking() -> None:
    race = hx.race(["tests.own_agents:Clumsy", "tests.own_agents:Clumsy"], **QUICK)
    assert [standing.rank for standing in race.standings] == [None, None]
    assert "failed: its agent failed: RuntimeError: I tripped" in repr(race)


@pytest.mark.parametrize(
    ("lanes", "arguments", "reason"),
    [
        ("greedy", {}, r"lanes is a list, such as \[training, .*, not 'greedy'"),
        (None, {}, r"lanes is a list, .*, not None"),
        (["greedy"], {"alpha": 0.1}, "unknown argument of a race 'alpha'; choose one of: steps"),
        (["q-learning"], {}, "give the lane its training, or keep_learning=True"),
        (["greedy"], {"devisions": 3}, r"'devisions'; choose .*; did you mean divisions\?$"),
        ([], {}, "1 to 6 lanes"),
        (["greedy"], {"on_step": 3}, "on_step is a function that is called, not 3"),
        (["greedy"], {"gait": "moonwalk"}, "unknown gait 'moonwalk'"),
    ],
)
def test_invalid_arguments_are_refused(lanes: Any, arguments: dict[str, Any], reason: str) -> None:
    with pytest.raises(hx.HexapodError, match=reason):
        hx.race(lanes, **{**QUICK, **arguments})


def test_invalid_lanes_are_refused(training: hx.Training) -> None:
    with pytest.raises(hx.UnknownName, match=r"argument of a look-ahead lane 'dept'; .*depth"):
        hx.lane("look-ahead", dept=2)
    with pytest.raises(TableMismatch, match="learned by q-learning, not by sarsa"):
        hx.lane("sarsa", table=training)
    for table in (training, 3):
        with pytest.raises(hx.InvalidInput, match="leave out table, or give the agent by its name"):
            hx.lane(training, table=table)  # type: ignore[arg-type]
    with pytest.raises(hx.InvalidInput, match="observation must be measured"):
        hx.lane(training, observation="commanded")
    with pytest.raises(TableMismatch, match="gait"):
        hx.race([training], gait="front-back-origin", **QUICK)
