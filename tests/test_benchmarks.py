"""`hx.benchmark`: the score of an agent in one call."""

import json
from pathlib import Path
from typing import Any

import pytest

import hexapods as hx
from tests.own_agents import Stumbling

SMALL: dict[str, Any] = {"tasks": "tripod", "budgets": [3, 6], "seeds": 3, "workers": 1}


@pytest.mark.test
def test_a_class_is_scored_and_its_file_is_that_of_the_command_line(tmp_path: Path) -> None:
    seen: list[tuple[int, int]] = []
    done = hx.benchmark(hx.QLearning, alpha=0.5, on_run=lambda *of: seen.append(of), **SMALL)
    assert seen == [(count, 6) for count in range(7)]
    assert done.config.agent == "q-learning"
    assert done.config.settings["alpha"] == 0.5
    [tripod] = done.tasks
    assert tripod.name == "tripod"
    assert tripod.score == pytest.approx(done.score)
    assert done.interval is not None
    assert done.interval[0] <= done.score <= done.interval[1]
    assert [entry.name for entry in done.budgets] == ["3", "6"]
    assert done.profile[0.0] == 1.0
    assert done.failed == {}
    assert repr(done).startswith("<Benchmark q-learning, hexabench-1, a part of the protocol: 0.")
    assert "tripod" in done._repr_html_()
    assert json.loads(done.save(tmp_path / "s.json").read_text()) == done.content
    assert done.row().startswith("| `q-learning` (alpha 0.5) | hexabench-1 (part: tripod) | 3 | ")


def test_all_runs_are_a_table() -> None:
    table = hx.benchmark("wave", tasks=["tripod", "ice"], seeds=2, workers=1).table()
    assert table["task"] == ["tripod", "tripod", "ice", "ice"]
    assert table["steps"] == [0, 0, 0, 0]
    assert table["seed"] == [0, 1, 0, 1]
    shares = [
        max(0.0, float(str(distance_m)) / float(str(best_m)))
        for distance_m, best_m in zip(table["distance_m"], table["best_known_m"], strict=True)
    ]
    assert table["score"] == pytest.approx(shares)


@pytest.mark.test
def test_with_a_file_it_goes_on_where_it_ended(tmp_path: Path) -> None:
    seen: list[int] = []
    first = hx.benchmark("q-learning", file=tmp_path / "s.json", **SMALL)
    more = hx.benchmark(
        "q-learning",
        file=tmp_path / "s.json",
        on_run=lambda count, _: seen.append(count),
        **{**SMALL, "seeds": 4},
    )
    assert seen == [6, 7, 8], "six of the eight runs were there"
    first_distances, more_distances = (
        scored.content["tasks"][0]["budgets"][0]["distances_m"] for scored in (first, more)
    )
    assert more_distances[:3] == first_distances


def test_a_run_that_fails_is_named_and_counts_as_0() -> None:
    done = hx.benchmark(Stumbling, tasks="tripod", budgets=5, seeds=1, workers=1)
    assert done.score == 0.0
    [(run, error)] = done.failed.items()
    assert run == "tripod, 5 steps, seed 0"
    assert "I tripped" in error
    assert done.tasks[0].failed == 1


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        ({"agent": 3}, "by its name or its class, not as 3"),
        ({"agent": "nobody"}, "unknown agent 'nobody'"),
        ({"agent": "q-learning", "budgets": 0}, "budget must be from 1"),
        ({"agent": "q-learning", "budgets": []}, "budgets must name at least one"),
        ({"agent": "q-learning", "budgets": ["ten"]}, "budget must be a whole number, not 'ten'"),
        ({"agent": "q-learning", "tasks": ["moon"]}, "unknown task of hexabench-1 'moon'"),
        ({"agent": "q-learning", "tasks": []}, "tasks must name at least one"),
        ({"agent": "q-learning", "protocol": "x"}, "unknown protocol 'x'; choose one of: hexab"),
        ({"agent": "q-learning", "seeds": 0}, "seeds must be from 1"),
        ({"agent": "q-learning", "seed": -1}, "seed must be at least 0"),
        ({"agent": "q-learning", "beta": 1}, "unknown setting of q-learning 'beta'"),
        ({"agent": "r-max", "objective": "average"}, "unknown setting of r-max 'objective'"),
        ({"agent": "q-learning", "on_run": 3}, "on_run is a function that is called, not 3"),
        ({"agent": "q-learning", "workers": 0}, "workers must be from 1"),
    ],
)
def test_bad_input_is_refused(arguments: dict[str, Any], reason: str) -> None:
    with pytest.raises(hx.InvalidInput, match=reason):
        hx.benchmark(**arguments)
