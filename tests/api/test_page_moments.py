"""Moments of runs, with which the page's sentences are compared, are as the API tells them now."""

import gzip
import json
from typing import Any

import pytest

from app.api.answers import RaceView, TrainingView
from app.api.event_answers import SceneLane, SceneView
from tests.page.moments import FILE

ENTRIES = json.loads(gzip.decompress(FILE.read_bytes()))


@pytest.mark.parametrize("entry", ENTRIES, ids=lambda entry: entry["run"]["name"])
def test_moments_have_the_members_of_the_api(entry: dict[str, Any]) -> None:
    """Where one is missing or gone, `make page-moments` computes them anew."""
    view = RaceView if entry["run"]["kind"] == "race" else TrainingView
    assert entry["run"].keys() == view.model_fields.keys()
    for moment in entry["moments"]:
        scene = moment["scene"]
        assert scene.keys() == SceneView.model_fields.keys()
        for lane in scene["lanes"]:
            assert lane.keys() == SceneLane.model_fields.keys()
