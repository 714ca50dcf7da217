"""Score files: JSON with all that is needed to repeat a benchmark."""

import json
from copy import deepcopy
from typing import Any

import pytest

from hexapods.benchmarking.runs import plan_tasks
from hexapods.benchmarking.score_file import (
    HEAD,
    config_of,
    decode,
    encode,
    results_of,
    row_of,
    score_content,
)
from hexapods.domain.errors import DamagedFile, UnknownName
from tests.benchmarking.sample_benchmarks import results, small, small_benchmark

pytestmark = pytest.mark.test


def test_it_has_what_the_issue_of_a_score_needs() -> None:
    content = small_benchmark().content
    assert content["protocol"] == "hexabench-1"
    assert content["agent"]["name"] == "q-learning"
    assert content["agent"]["settings"]["alpha"] == 0.3
    assert {"racing-hexapods", "mujoco", "numpy", "python", "platform"} < set(content["versions"])
    for entry in (*content["tasks"], content["aggregate"]):
        low, high = entry["interval"]
        assert low <= entry["score"] <= high
    assert content["tasks"][0]["best_known_m"] > 0.6
    assert content["is_whole_protocol"] is False


def test_it_is_read_as_it_was_written() -> None:
    done = small_benchmark()
    content = decode(encode(done.content), "s.json")
    assert content == done.content
    assert config_of(content) == done.config
    assert len(results_of(content)) == 6


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (b"", "s.json is no score file"),
        (b"[]", "s.json is no score file"),
        (b'{"format": 1, "protocol": "hexabench-1"}', "it lacks 'agent'"),
        (
            b'{"format": 9, "protocol": "hexabench-1"}',
            "s.json has format 9; this version reads 1 alone",
        ),
        (b'{"format": NaN}', "NaN is no number in JSON"),
        (b"[" * 100_000, "s.json is no score file"),
    ],
)
def test_what_is_no_score_file_is_refused(data: bytes, reason: str) -> None:
    with pytest.raises(DamagedFile, match=reason):
        decode(data, "s.json")


def test_a_protocol_that_this_version_does_not_know_is_refused_with_those_that_it_does() -> None:
    changed = {**small_benchmark().content, "protocol": "hexabench-7"}
    with pytest.raises(UnknownName, match="'hexabench-7'; choose one of: hexabench-1"):
        decode(encode(changed), "s.json")


@pytest.mark.parametrize("distance", [None, "far", [1]])
def test_distances_that_are_no_numbers_are_refused(distance: Any) -> None:
    changed = deepcopy(dict(small_benchmark().content))
    changed["tasks"][0]["budgets"][0]["distances_m"][0] = distance
    with pytest.raises(DamagedFile):
        decode(json.dumps(changed).encode(), "s.json")


def test_its_row_is_a_line_of_the_table_and_says_that_it_is_a_part() -> None:
    row = row_of(small_benchmark().content)
    assert row.count("|") == HEAD.count("|")
    assert row.startswith("| `q-learning` | hexabench-1 (part: tripod) | 3 | ")
    assert "3: " in row
    assert "6: " in row


def test_the_row_of_a_whole_protocol_has_its_name_alone() -> None:
    config = small("greedy", tasks=None, budgets=None, seeds=None)
    best_known = {plan.task.name: plan.task.best_known for plan in plan_tasks(config)}
    content = score_content(config, plan_tasks(config), results(config, 0.2), best_known)
    assert content["is_whole_protocol"] is True
    assert row_of(content).startswith("| `greedy` | hexabench-1 | 30 | ")
    assert "does not practise" in row_of(content)


def test_the_row_has_settings_that_differ_from_the_defaults() -> None:
    config = small(settings={"alpha": 0.5}, observation="planned", seed=4)
    best_known = {plan.task.name: plan.task.best_known for plan in plan_tasks(config)}
    row = row_of(score_content(config, plan_tasks(config), results(config, 0.2), best_known))
    assert row.startswith(
        "| `q-learning` (alpha 0.5, planned) | hexabench-1 (part: tripod; seed 4)"
    )
