"""A run's walk as files for other programs, over REST."""

import csv
import io
from typing import Any

import pytest

from app.api.policy import policies
from app.api.work import DOWNLOAD, ENCODING
from hexapods.exports.registry import EXPORTS
from tests.api.calls import Api, refused

PARQUET_TYPE = EXPORTS["trajectory"].file("parquet").media_type


@pytest.fixture(scope="module")
def raced(api: Api) -> dict[str, Any]:
    """Return a finished race of two lanes with physics."""
    lanes = [{"agent": "greedy"}, {"agent": "wave"}]
    return api.finished(api.race(lanes=lanes, simulator="mujoco", steps=6))


def test_trajectory_of_a_race_has_its_torques(api: Api, raced: dict[str, Any]) -> None:
    answer = api.call("GET", f"/runs/{raced['id']}/trajectory", params={"lane": 1})
    assert answer.status_code == 200
    assert answer.headers["content-type"].startswith("text/csv")
    assert f"race-{raced['id']}.csv" in answer.headers["content-disposition"]
    first, *_, last = csv.DictReader(io.StringIO(answer.text))

    assert (first["lane"], first["step"], first["leg1_coxa_torque_nm"]) == ("1", "0", "")
    assert last["step"] == "6"
    assert float(last["time_s"]) == pytest.approx(6 * 0.32)
    assert any(float(last[f"leg{leg}_femur_torque_nm"]) for leg in range(1, 7))
    assert float(last["body_y_m"]) == pytest.approx(
        raced["result"]["lanes"][1]["total_distance_m"], abs=1e-5
    )


def test_trajectory_as_parquet(api: Api, raced: dict[str, Any]) -> None:
    answer = api.call("GET", f"/runs/{raced['id']}/trajectory", headers={"Accept": PARQUET_TYPE})
    assert answer.headers["content-type"] == PARQUET_TYPE
    assert (answer.content[:4], answer.content[-4:]) == (b"PAR1", b"PAR1")


def test_page_of_a_race_is_a_file_with_its_own_policy(api: Api, raced: dict[str, Any]) -> None:
    answer = api.call("GET", f"/runs/{raced['id']}/page")
    assert answer.status_code == 200
    assert f'filename="race-{raced["id"]}.html"' in answer.headers["content-disposition"]
    assert answer.text.count('<meta http-equiv="Content-Security-Policy" content="default-src') == 1
    assert all(f'id="segment-{clock}-0"' in answer.text for clock in ("free", "paper", "wall"))
    refused(api.call("GET", "/runs/nothing/page"), 404, "nothing")


def test_log_of_a_race(api: Api, raced: dict[str, Any]) -> None:
    answer = api.call("GET", f"/runs/{raced['id']}/mcap", params={"clock": "free"})
    assert answer.content[:8] == answer.content[-8:] == b"\x89MCAP0\r\n"
    assert f'filename="race-{raced["id"]}.mcap"' in answer.headers["content-disposition"]


@pytest.mark.promises
def test_video_of_a_race(api: Api, raced: dict[str, Any]) -> None:
    def video(**query: Any) -> Any:
        return api.call("POST", f"/runs/{raced['id']}/video", params=query)

    answer = video(format="gif", width=160, height=120, fps=2, clock="free")
    assert (answer.status_code, answer.headers["content-type"]) == (200, "image/gif")
    assert answer.content[:6] == b"GIF89a"
    refused(video(width=161), 422, "width must be an even number of pixels")
    refused(video(playback_speed=0), 422, "playback_speed must be a number from 0.05 to 64")
    refused(video(fps=60, playback_speed=0.05), 422, "more than 900 frames; choose a higher speed")


def test_a_stopped_race_has_the_files_of_what_it_walked(api: Api) -> None:
    race = api.race(lanes=[{"agent": "two-step"}], divisions=4, steps=5000)
    api.until(race, lambda now: now["progress"]["done"] > 0)
    api.stop(race)
    stopped = api.ended(race)
    assert stopped["state"] == "stopped"

    rows = csv.DictReader(io.StringIO(api.call("GET", f"/runs/{race['id']}/trajectory").text))
    assert max(int(row["step"]) for row in rows) >= stopped["progress"]["done"] > 0
    for path in (f"/runs/{race['id']}/page", f"/races/{race['id']}/recording"):
        assert api.call("GET", path).status_code == 200


def test_what_has_no_trajectory_is_refused(api: Api, raced: dict[str, Any]) -> None:
    def trajectory(run_id: str, **query: Any) -> Any:
        return api.call("GET", f"/runs/{run_id}/trajectory", params=query)

    refused(trajectory("nothing"), 404, "nothing")
    refused(trajectory(raced["id"], lane=2), 422, "Lane must be from 0 to 1, not 2")
    refused(trajectory(raced["id"], lane=-1), 422, "lane must be a whole number")
    refused(trajectory(raced["id"], format="xlsx"), 422, "format must be")
    queued = api.race(lanes=[{"agent": "q-learning", "training": {"steps": 10_000_000}}])
    refused(trajectory(queued["id"]), 409, "its walk can be had as a file once it ended")
    api.stop(queued)


def test_each_file_has_the_slots_of_what_it_costs(api: Api) -> None:
    of_routes = policies(api.client.app)  # type: ignore[arg-type]
    assert of_routes["get", "/api/v1/runs/{run_id}/page"].work == ENCODING
    assert of_routes["get", "/api/v1/runs/{run_id}/trajectory"].work == DOWNLOAD
