"""`table()` of experiments and races: tidy columns of plain values, for any library, and as CSV."""

import csv
from pathlib import Path
from typing import Any

import pyarrow
import pytest

import hexapods as hx
from hexapods.domain.world import parse_world

KINEMATIC: dict[str, Any] = {"simulator": "kinematic", "gaits": "left-right-origin", "workers": 1}
SPACES = set("\u00a0\u2007\u2009\u202f")
PLAIN = (bool, int, float, str, type(None))


@pytest.fixture(scope="module")
def sweep() -> hx.Experiment:
    agents: list[Any] = [hx.QLearning, "n-step-sarsa"]
    return hx.experiment(
        "sweep", agents=agents, seeds=2, steps=20, alpha=[0.1, 0.3], return_steps=[2], **KINEMATIC
    )


@pytest.fixture(scope="module")
def race() -> hx.Race:
    training = hx.train(steps=20, simulator="kinematic")
    lanes: list[Any] = [training, hx.lane("beam", width=3), "greedy"]
    return hx.race(lanes, world=["sensor-noise:sd_m=0.001"], steps=5, seed=4)


def check_tidy(table: hx.ResultTable) -> None:
    """Columns have equal lengths, plain values of one type, and no spaces that do not break."""
    assert len({len(column) for column in table.values()}) == 1
    for name, column in table.items():
        assert name.isidentifier(), name
        kinds = {type(value) for value in column} - {type(None)}
        assert len(kinds) <= 1, (name, kinds)
        assert kinds <= set(PLAIN), (name, kinds)
        assert not any(SPACES & set(value) for value in column if isinstance(value, str)), name
    # What pandas and polars do, too: they take a mapping of columns, and infer one type of each.
    assert pyarrow.table(dict(table)).column_names == list(table)


def test_an_experiment_has_a_row_for_each_trial(sweep: hx.Experiment) -> None:
    table = sweep.table()
    check_tidy(table)
    assert table["trial"] == list(sweep.trials)
    assert [result.distances_m[-1] for result in sweep.trials.values()] == table["distance_m"]
    rows = [row for row in table.rows if row["agent"] == "q-learning"]
    assert sorted((row["alpha"], row["return_steps"], row["seed_number"]) for row in rows) == [
        (0.1, None, 0),
        (0.1, None, 1),
        (0.3, None, 0),
        (0.3, None, 1),
    ]
    [gait], [world], [steps] = ({row[name] for row in rows} for name in ("gait", "world", "steps"))
    assert (gait, world, steps) == ("left-right-origin", "flat", 20)
    assert len({row["seed"] for row in rows}) == 4


def test_a_trial_that_walks_several_times_has_a_column_for_each_walk() -> None:
    league = hx.experiment(
        "league", agents="q-learning", seeds=1, steps=50, worlds="flat", **KINEMATIC
    )
    table = league.table()
    check_tidy(table)
    [learner] = [row for row in table.rows if row["role"] == "learner"]
    walks = [learner["distance_after_25_m"], learner["distance_after_50_m"]]
    assert league.trials[str(learner["trial"])].distances_m == tuple(walks)
    assert learner["distance_m"] == learner["distance_after_50_m"]


def test_a_race_has_a_row_for_each_lane_and_each_step(race: hx.Race) -> None:
    lanes, steps = race.table(), race.step_table()
    check_tidy(lanes)
    check_tidy(steps)
    assert [tuple(row[name] for name in hx.Standing._fields) for row in lanes.rows] == [
        tuple(standing) for standing in race.standings
    ]
    [beam] = [row for row in lanes.rows if row["agent"] == "beam"]
    assert (beam["width"], beam["seed"]) == (3, 4)
    assert parse_world(str(beam["world"])) == race.config.world
    assert race.table("free")["lane"] == [row.lane for row in race.standings_under("free")]
    last = steps.rows[-1]
    assert len(steps["lane"]) == 15
    recorded = race.recording[2].steps[4]
    assert (last["agent"], last["step"], last["distance_m"]) == ("greedy", 5, recorded.distance_m)
    assert (last["group"], last["cell"]) == recorded.action
    assert tuple(last[f"observed_{group}"] for group in range(3)) == recorded.observation


def test_a_lane_that_failed_says_why() -> None:
    race = hx.race(["tests.own_agents:Cheat", "greedy"], steps=2, simulator="kinematic")
    failures = {row["agent"]: row["failure"] for row in race.table().rows}
    assert "not a legal action" in str(failures["tests.own_agents:Cheat"])
    assert failures["greedy"] is None


def test_a_table_is_written_as_csv(race: hx.Race, tmp_path: Path) -> None:
    table = race.table()
    with table.save_csv(tmp_path / "race.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["agent"] for row in rows] == table["agent"]
    assert [float(row["total_distance_m"]) for row in rows] == table["total_distance_m"]
    assert rows[0]["failure"] == ""


def test_values_of_a_column_have_one_type() -> None:
    table = hx.ResultTable.of([{"a": 1, "b": "x\u00a0y"}, {"a": 0.5, "b": 3}, {"a": None}])
    assert dict(table) == {"a": [1.0, 0.5, None], "b": ["x y", "3", None]}
    assert table.rows[2] == {"a": None, "b": None}


def test_names_of_settings_have_spaces_that_can_be_typed(sweep: hx.Experiment) -> None:
    names = [setting.name for setting in sweep.settings]
    assert "Q-learning, 20 steps, α 0.1" in names
    assert not SPACES & set("".join(names))
