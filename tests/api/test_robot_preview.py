"""Preview of a robot over REST before it walks."""

from typing import Any

import pytest

from tests.api.calls import Api, refused


def preview_of(api: Api, body: dict[str, Any]) -> Any:
    answer = api.call("POST", "/robots/preview", json=body)
    assert answer.status_code == 200, answer.text
    return answer.json()


def test_support_states_and_law_are_previewed(api: Api) -> None:
    preview = preview_of(api, {"gait": "tripod"})

    assert (preview["states"], preview["actions"]) == (25, 8)
    assert preview["tips"] is False
    assert preview["better"] is None
    assert preview["groups"][0]["legs"] == [1, 3, 5]
    assert preview["legs"][0]["home_m"] == pytest.approx([0.125, 0.2165], abs=1e-4)


def test_a_body_of_ones_own_that_tips_is_offered_other_groups(api: Api) -> None:
    places = [(0.1, 0.2), (-0.1, 0.2), (-0.1, -0.2), (0.1, -0.2)]
    legs = [{"x_m": x, "y_m": y, "foot_out_m": 0.12} for x, y in places]
    preview = preview_of(api, {"gait": "pace", "robot": {"legs": legs}})

    assert preview["tips"] is True
    assert preview["better"]["gait"]["groups"] == [[1, 3], [2, 4]]
    assert preview["better"]["margin_m"] >= -1e-6


def test_a_learner_is_recommended_for_body_and_gait(api: Api) -> None:
    """The options have it for the named gaits of each robot, as the preview has it of any gait."""
    options = api.call("GET", "/options").json()
    learners = {agent["name"] for agent in options["agents"] if agent["learns"]}
    by_robot = {robot["name"]: robot["recommended_agent"] for robot in options["robots"]}
    for robot in options["robots"]:
        assert [*robot["recommended_agent"]] == robot["gaits"]
        assert {*robot["recommended_agent"].values()} <= learners
    for robot, gait in (("dog", "trot"), ("dog", "bound"), ("stiff", "pace")):
        preview = preview_of(api, {"gait": gait, "robot": robot})
        assert preview["recommended_agent"] == by_robot[robot][gait]
        assert ("It tips" in preview["recommended_because"]) == preview["tips"]
    assert by_robot["dog"]["trot"] != by_robot["dog"]["bound"]


def test_the_body_is_written_out_with_its_grid(api: Api) -> None:
    preview = preview_of(api, {"gait": "trot", "robot": "dog"})

    front = preview["legs"][0]["built"]
    assert (front["x_m"], front["y_m"]) == pytest.approx((0.06, 0.11))
    assert (front["yaw_deg"], front["foot_out_m"], front["femur_m"]) == (20, 0.12, 0.08)
    assert preview["built"]["torso_length_m"] == 0.26
    assert preview["forward_deg"] == pytest.approx(90)
    assert [0.02, 0.02] in preview["cells_m"]
    assert preview_of(api, {"gait": "tripod"})["built"]["torso_length_m"] is None


def test_legs_that_cannot_be_so_are_named(api: Api) -> None:
    places = [(0.1, 0.1), (-0.1, 0.1), (-0.1, 0.1), (0.1, -0.1)]
    legs = [{"x_m": x, "y_m": y, "foot_out_m": 0.1} for x, y in places]
    body = {"gait": "one-by-one", "robot": {"legs": legs}}
    answer = api.call("POST", "/robots/preview", json=body)

    refused(answer, 422, "feet of legs 2 and 3")
    assert answer.json()["legs"] == [2, 3]


def test_an_invalid_gait_or_field_is_refused(api: Api) -> None:
    bodies: list[tuple[dict[str, Any], str]] = [({"robot": "dog"}, "six"), ({"steps": 3}, "steps")]
    for body, word in bodies:
        answer = api.call("POST", "/robots/preview", json={"gait": "tripod", **body})
        refused(answer, 422, word)
