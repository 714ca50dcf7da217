"""Trainings in Python: what a learner's table holds, as columns."""

from typing import Any

import numpy as np
import pytest

import hexapods as hx

WALK: dict[str, Any] = {
    "gait": "left-right-origin",
    "simulator": "kinematic",
    "steps": 40,
    "evaluate_every": 0,
}


def test_values_have_a_row_for_each_state_and_action() -> None:
    values = hx.train("q-learning", **WALK).values()

    assert list(values) == [
        *("state_0", "state_1", "state_2", "action_pair", "action_cell", "value", "visits")
    ]
    assert len(values.rows) == 1500
    assert np.sum(np.array(values["visits"], float)) == 40


def test_values_of_a_learner_over_landings_have_a_row_for_each_landing() -> None:
    training = hx.train("afterstate-q", **WALK)
    values = training.values()

    assert list(values) == ["landing_0", "landing_1", "landing_2", "value", "visits"]
    assert len(values.rows) == 125
    assert np.sum(np.array(values["visits"], float)) == 40
    best = max(values.rows, key=lambda row: float(row["value"] or 0))
    landing = tuple(int(best[f"landing_{group}"] or 0) for group in range(3))
    table = training.agent.table  # type: ignore[attr-defined]  # of a learner with one
    assert table.best(table.index((*landing[:2], (landing[2] + 1) % 5))) == best["value"]


def test_an_agent_without_a_table_has_no_values() -> None:
    with pytest.raises(hx.TableMismatch, match="linear-model keeps no Q-table"):
        hx.train("linear-model", **WALK).values()
