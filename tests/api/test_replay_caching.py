"""Segments of replays in caches: a segment with all its frames is sent once, and never changes."""

from pathlib import Path
from typing import Any

import httpx2
import pytest

from app.settings import Settings
from tests.api.calls import Api
from tests.api.conftest import running

TOKEN = "a-token-that-is-long-enough"
SHORT = {"lanes": [{"agent": "greedy"}], "steps": 3}


@pytest.fixture(scope="module")
def race(api: Api) -> dict[str, Any]:
    return api.finished(api.race(**SHORT))


def segment(
    api: Api,
    run: dict[str, Any],
    headers: dict[str, str] | None = None,
    *,
    number: int = 0,
    **query: Any,
) -> httpx2.Response:
    path = f"/runs/{run['id']}/replay/segments/0/{number}"
    return api.call("GET", path, params=query, headers=headers)


def version_of(api: Api, race: dict[str, Any]) -> str:
    version: str = api.get(f"/runs/{race['id']}/replay")["version"]
    return version


def test_with_the_version_of_the_plan_a_segment_is_immutable(
    api: Api, race: dict[str, Any]
) -> None:
    answer = segment(api, race, version=version_of(api, race))
    assert answer.status_code == 200
    assert answer.headers["cache-control"] == "public, s-maxage=3600, max-age=31536000, immutable"
    assert answer.headers["etag"].endswith('-gzip"')


def test_where_watching_needs_the_token_only_the_browser_stores_it(tmp_path: Path) -> None:
    settings = Settings(data=tmp_path, token=TOKEN, spectators="token", job_niceness=0)
    with running(settings) as guarded:
        guarded.client.headers["Authorization"] = f"Bearer {TOKEN}"
        race = guarded.finished(guarded.race(**SHORT))
        answer = segment(guarded, race, version=version_of(guarded, race))
        assert answer.headers["cache-control"] == "private, max-age=31536000, immutable"
        del guarded.client.headers["Authorization"]
        assert segment(guarded, race).status_code == 401


@pytest.mark.parametrize("version", [{}, {"version": "another"}])
def test_without_it_a_segment_is_revalidated(
    version: dict[str, Any], api: Api, race: dict[str, Any]
) -> None:
    answer = segment(api, race, None, **version)
    assert answer.headers["cache-control"] == "no-cache"
    again = segment(api, race, {"If-None-Match": answer.headers["etag"]}, **version)
    assert (again.status_code, again.content) == (304, b"")
    assert again.headers["etag"] == answer.headers["etag"]


def test_each_encoding_clock_and_version_has_its_own_tag(api: Api, race: dict[str, Any]) -> None:
    plain = segment(api, race, {"Accept-Encoding": "identity"})
    tags = {plain.headers["etag"], segment(api, race).headers["etag"]}
    tags.add(segment(api, race, clock="free").headers["etag"])
    before = version_of(api, race)
    api.call("PATCH", f"/runs/{race['id']}", json={"name": "renamed"})
    assert version_of(api, race) != before
    tags.add(segment(api, race).headers["etag"])
    assert len(tags) == 4


def test_what_a_run_has_not_recorded_yet_is_requested_anew(api: Api) -> None:
    training = api.slow_training()
    api.tell(training, "pause")
    api.until(training, lambda now: now["state"] == "paused")
    plan = api.get(f"/runs/{training['id']}/replay")
    frames = plan["recorded_s"][-1][1] / plan["frame_s"]
    newest = int(frames / plan["segment_frames"])
    answer = segment(api, training, number=newest, version=plan["version"])
    assert answer.status_code == 200
    assert answer.headers["cache-control"] == "no-cache"
    assert "etag" not in answer.headers
    api.stop(training)
