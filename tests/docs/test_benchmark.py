"""docs/benchmark.md, where it can be held to what it says."""

import re

import pytest

from hexapods.benchmarking.protocol import protocol
from tests.cli.running import ROOT

TEXT = (ROOT / "docs" / "benchmark.md").read_text("utf-8")
TASKS = protocol("hexabench-1").tasks
ROWS = re.findall(
    r"^\| `([\w-]+)` \| [^|]+ \| [^|]+ \| (\d\.\d{3}) m \| ([^|]+) \|$", TEXT, flags=re.MULTILINE
)


def test_every_task_is_there_with_its_best_known_walk() -> None:
    assert [name for name, _, _ in ROWS] == list(TASKS)


@pytest.mark.parametrize(("name", "distance_m", "found_by"), ROWS)
def test_a_best_known_walk_is_that_of_the_protocol(
    name: str, distance_m: str, found_by: str
) -> None:
    best_known = TASKS[name].best_known
    assert distance_m == f"{best_known.distance_m:.3f}"
    assert found_by == best_known.found_by
