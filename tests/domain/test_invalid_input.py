"""`InvalidInput` is a `ValueError`, and what reads files and requests tells it as it was raised."""

import pickle
from typing import Any

import pytest

import hexapods as hx
from hexapods.domain.records import from_json, to_json
from hexapods.runs.config import TrainingConfig, training_config


@pytest.mark.parametrize(
    "arguments", [{"robot": "stif"}, {"steps": 0}, {"alpha": 7}, {"world": ["limp:legs=9"]}]
)
def test_an_invalid_argument_is_a_value_error(arguments: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=r"stif|steps|alpha|leg") as raised:
        hx.train(**arguments)
    assert isinstance(raised.value, hx.InvalidInput)
    again = pickle.loads(pickle.dumps(raised.value))
    assert (type(again), str(again)) == (type(raised.value), str(raised.value))


@pytest.mark.parametrize(
    ("change", "kind", "reason"),
    [
        ({"robot": {"preset": "stif"}}, hx.UnknownName, "unknown robot 'stif'"),
        ({"steps": 0}, hx.InvalidInput, "steps must be"),
        ({"disturbances": [{"kind": "limp", "legs": [9]}]}, hx.InvalidInput, "leg"),
        ({"settings": {"alpha": [1]}}, hx.InvalidInput, "alpha must be a number"),
    ],
)
def test_an_invalid_stored_value_keeps_the_message_of_its_error(
    change: dict[str, Any], kind: type[hx.InvalidInput], reason: str
) -> None:
    stored = {**to_json(training_config(gait="left-right-origin")), **change}
    with pytest.raises(kind, match=f"^{reason}" if "unknown" in reason else reason) as raised:
        from_json(TrainingConfig, stored)
    assert "Value error" not in str(raised.value)
