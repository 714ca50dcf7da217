"""The gait of a run: of races, trainings and what has none."""

from typing import Any

import pytest

from app.features.gait_analysis.routes import GaitAnalysis
from hexapods.domain.records import from_json
from tests.api.calls import Api, refused


@pytest.fixture(scope="module")
def raced(api: Api) -> dict[str, Any]:
    """Return a finished race of two lanes with physics."""
    lanes = [{"agent": "greedy"}, {"agent": "informed"}]
    return api.finished(api.race(lanes=lanes, simulator="mujoco", steps=12))


def gait(api: Api, run: dict[str, Any], **query: Any) -> GaitAnalysis:
    return from_json(GaitAnalysis, api.get(f"/runs/{run['id']}/gait", params=query))


def test_gait_of_a_race_has_the_figures_of_each_lane(api: Api, raced: dict[str, Any]) -> None:
    view = gait(api, raced)

    assert view.part == "race"
    assert view.step_s == pytest.approx(0.32)
    assert [lane.agent for lane in view.lanes] == ["greedy", "informed"]
    for lane, result in zip(view.lanes, raced["result"]["lanes"], strict=True):
        assert lane.recorded_to_s == pytest.approx(12 * 0.32)
        assert lane.no_effort is None
        figures = lane.figures
        assert figures is not None
        assert figures.distance_m == pytest.approx(result["total_distance_m"], abs=0.003)
        assert [leg.leg for leg in figures.legs] == [1, 2, 3, 4, 5, 6]
        assert 0.6 < figures.duty_factor < 0.9
        assert figures.effort is not None
        assert figures.effort.cost_of_transport is not None


def test_gait_of_a_race_that_goes_on_is_new_and_of_one_that_ended_is_kept(
    api: Api, raced: dict[str, Any]
) -> None:
    lanes = [{"agent": "look-ahead", "settings": {"depth": 3}}]
    running = api.race(lanes=lanes, simulator="kinematic", steps=200)
    ends, done = [], 0
    for _ in range(2):
        api.until(running, lambda now, done=done: now["progress"]["done"] > done)
        ends.append(gait(api, running).lanes[0].recorded_to_s)
        done = api.look(running)["progress"]["done"]
    api.stop(running)
    assert 0 < ends[0] < ends[1]
    path = f"/runs/{raced['id']}/gait"
    assert api.call("GET", path).content == api.call("GET", path).content


def test_gait_of_a_part_of_a_race(api: Api, raced: dict[str, Any]) -> None:
    figures = gait(api, raced, from_s=1.0, to_s=2.5).lanes[0].figures

    assert figures is not None
    assert (figures.from_s, figures.to_s) == (1.0, 2.5)
    assert min(start for leg in figures.legs for start, _ in leg.stance) >= 1.0
    assert 1.0 <= figures.posture.time_s[0] < figures.posture.time_s[-1] <= 2.5


def test_gait_of_a_training_is_of_its_practice_or_its_newest_evaluation(
    api: Api, trained: dict[str, Any]
) -> None:
    practice, evaluation = (gait(api, trained, part=kind) for kind in ("practice", "evaluation"))

    assert [practice.part, evaluation.part] == ["practice", "evaluation"]
    assert practice.lanes[0].recorded_to_s == pytest.approx(100 * 0.32)
    assert evaluation.lanes[0].recorded_to_s == pytest.approx(50 * 0.32)
    assert evaluation.lanes[0].figures is not None
    assert evaluation.lanes[0].figures.distance_m == pytest.approx(
        trained["result"]["distance_m"], abs=1e-4
    )
    assert practice.lanes[0].no_effort is not None
    assert "no servos" in practice.lanes[0].no_effort


@pytest.mark.parametrize(
    ("query", "words"),
    [
        ({"from_s": -1}, "from_s must be a number of seconds of robot time, 0 or more"),
        ({"from_s": "nan"}, "from_s must be a number of seconds"),
        ({"from_s": 100}, "after the end of the recording; choose a from_s under 3.84"),
        ({"from_s": 2, "to_s": 1}, "The window ends before it begins; choose a to_s over 2"),
        ({"from_s": 0, "to_s": 1000}, "choose a to_s at most 120 s after from_s"),
        ({"part": "race"}, "part must be practice, or evaluation"),
    ],
)
def test_an_invalid_window_is_refused(
    api: Api, raced: dict[str, Any], query: dict[str, Any], words: str
) -> None:
    refused(api.call("GET", f"/runs/{raced['id']}/gait", params=query), 422, words)


def test_what_was_not_recorded_has_no_gait(api: Api) -> None:
    refused(api.call("GET", "/runs/nothing/gait"), 404, "nothing")
    queued = api.race(lanes=[{"agent": "q-learning", "training": {"steps": 10_000_000}}])
    refused(api.call("GET", f"/runs/{queued['id']}/gait"), 409, "has no recording (yet)")
    api.stop(queued)
