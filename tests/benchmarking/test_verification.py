"""Score files are repeated to the last bit, and what was changed is told."""

from copy import deepcopy
from typing import Any

import pytest

from hexapods.benchmarking.verification import verification, version_note
from hexapods.domain.errors import InvalidInput
from tests.benchmarking.sample_benchmarks import small_benchmark

pytestmark = pytest.mark.test


def changed() -> dict[str, Any]:
    return deepcopy(dict(small_benchmark().content))


def test_a_score_file_repeats() -> None:
    outcome = verification(small_benchmark().content, workers=1)
    assert outcome.differences == []
    assert outcome.repeated == 6
    assert version_note(small_benchmark().content) is None


def test_a_changed_distance_is_reported() -> None:
    content = changed()
    content["tasks"][0]["budgets"][1]["distances_m"][2] = 0.6
    outcome = verification(content, workers=1)
    assert outcome.differences[0].startswith("tripod, 6 steps, seed 2: 0.6 m in the file, ")
    assert not outcome.is_rounding


def test_a_changed_score_is_reported_although_no_run_is_repeated_for_it() -> None:
    content = changed()
    content["aggregate"]["score"] = 0.99
    outcome = verification(content, workers=1, sample=1)
    assert outcome.repeated == 1
    assert len(outcome.differences) == 1
    assert outcome.differences[0].startswith("aggregate score: 0.99 in the file, ")


def test_another_best_known_distance_is_reported() -> None:
    content = changed()
    content["tasks"][0]["best_known_m"] = 0.3
    [difference] = verification(content, workers=1, sample=1).differences
    assert difference.startswith("tasks tripod best_known_m: 0.3 in the file, ")


def test_last_digits_are_distinguished_from_other_differences() -> None:
    content = changed()
    content["tasks"][0]["budgets"][0]["distances_m"][0] += 1e-14
    outcome = verification(content, workers=1)
    assert outcome.differences
    assert outcome.is_rounding
    content["versions"]["mujoco"] = "3.0.0"
    assert "mujoco 4" in (version_note(content) or "")


def test_missing_runs_are_reported() -> None:
    content = changed()
    content["tasks"][0]["budgets"][0]["distances_m"].pop()
    outcome = verification(content, workers=1)
    assert outcome.differences == ["The file has 5 runs; its benchmark has 6."]


@pytest.mark.parametrize("sample", [0, 7])
def test_a_sample_is_of_the_runs_that_there_are(sample: int) -> None:
    with pytest.raises(InvalidInput, match="sample must be from 1 to 6"):
        verification(small_benchmark().content, workers=1, sample=sample)
