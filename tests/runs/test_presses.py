"""Presses of people who watch a training: what is valid, and that they are part of the run."""

from typing import Any

import pytest

import hexapods as hx
from hexapods.domain.errors import InvalidInput
from hexapods.experiments.trial import TrialConfig
from hexapods.runs.config import training_config
from hexapods.runs.presses import MAX_PRESSES, read_presses, teachable_agents

WALK: dict[str, Any] = {"gait": "tripod", "simulator": "kinematic", "steps": 40, "seed": 3}
PRESSES: list[dict[str, Any]] = [
    {"step": 6, "presses": [[5.2, 1], [5.9, -0.25]]},
    {"step": 21, "presses": [[20.0, -1]]},
]


def taught(**more: Any) -> hx.Training:
    return hx.train("tamer", trainer="people", **{"changes": PRESSES, **WALK, **more})


def test_presses_are_numbers_as_they_are_recorded() -> None:
    assert read_presses([(3, 1), [4.5, -0.5]], "tamer") == [[3.0, 1.0], [4.5, -0.5]]


@pytest.mark.parametrize(
    "value",
    [
        [],
        "+",
        [1, 1],
        [[1, 2]],
        [[-1, 1]],
        [[1, True]],
        [[float("nan"), 1]],
        [[1, 1, 1]],
        [[1, 1]] * (MAX_PRESSES + 1),
    ],
)
def test_what_is_no_press_is_refused_with_what_is(value: object) -> None:
    with pytest.raises(InvalidInput, match="pairs: steps done in the picture"):
        read_presses(value, "tamer")


def test_agents_that_do_not_learn_from_presses_are_told_which_do() -> None:
    assert teachable_agents() == ["tamer"]
    with pytest.raises(InvalidInput, match="those that do: tamer"):
        hx.train("q-learning", changes=PRESSES, **WALK)


def test_the_same_presses_teach_the_same_table() -> None:
    first, again = taught(), taught()
    other = taught(changes=[{"step": 6, "presses": [[5.2, -1]]}])

    assert first.to_bytes() == again.to_bytes()
    assert first.q_table_sha256 != other.q_table_sha256


@pytest.mark.parametrize("stopped_at", [3, 6, 30])
def test_a_training_with_presses_resumes_to_the_last_bit(stopped_at: int) -> None:
    practice = hx.iter_train("tamer", trainer="people", changes=PRESSES, **WALK)
    for _ in practice:
        if practice.step == stopped_at:
            break

    assert hx.resume(practice.training).q_table_sha256 == taught().q_table_sha256


def test_people_train_only_where_they_press() -> None:
    with pytest.raises(InvalidInput, match="presses alone"):
        hx.train("tamer", trainer="people", **WALK)
    with pytest.raises(InvalidInput, match="presses alone"):
        TrialConfig(training=training_config("tamer", trainer="people", **WALK))
