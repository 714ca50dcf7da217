"""What is told of a robot over REST before it walks."""

from typing import Any

import pytest

from tests.api.calls import Api, refused


def told(api: Api, body: dict[str, Any]) -> Any:
    answer = api.call("POST", "/robots/preview", json=body)
    assert answer.status_code == 200, answer.text
    return answer.json()


def test_support_states_and_law_are_told_before_anything_runs(api: Api) -> None:
    known = told(api, {"gait": "tripod"})

    assert (known["states"], known["actions"]) == (25, 8)
    assert known["tips"] is False
    assert known["better"] is None
    assert known["groups"][0]["legs"] == [1, 3, 5]
    assert known["legs"][0]["home_m"] == pytest.approx([0.125, 0.2165], abs=1e-4)


def test_a_body_of_ones_own_that_tips_is_offered_other_groups(api: Api) -> None:
    places = [(0.1, 0.2), (-0.1, 0.2), (-0.1, -0.2), (0.1, -0.2)]
    legs = [{"x_m": x, "y_m": y, "foot_out_m": 0.12} for x, y in places]
    known = told(api, {"gait": "pace", "robot": {"legs": legs}})

    assert known["tips"] is True
    assert known["better"]["gait"]["groups"] == [[1, 3], [2, 4]]
    assert known["better"]["margin_m"] >= -1e-6


def test_what_makes_no_sense_is_refused(api: Api) -> None:
    bodies: list[tuple[dict[str, Any], str]] = [({"robot": "dog"}, "six"), ({"steps": 3}, "steps")]
    for body, word in bodies:
        answer = api.call("POST", "/robots/preview", json={"gait": "tripod", **body})
        refused(answer, 422, word)
