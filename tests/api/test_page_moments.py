"""Moments of runs, with which the page's sentences are compared, are as the API tells them now."""

import gzip
import json
from dataclasses import fields
from typing import Any

import pytest

from app.events.run_view import RaceView, TrainingView
from hexapods.shows.scene_view import SceneLane, SceneView
from tests.page.moments import FILE


def field_names(record: type[Any]) -> set[str]:
    return {field.name for field in fields(record)}


ENTRIES = json.loads(gzip.decompress(FILE.read_bytes()))


@pytest.mark.parametrize("entry", ENTRIES, ids=lambda entry: entry["run"]["name"])
def test_moments_have_the_members_of_the_api(entry: dict[str, Any]) -> None:
    """Where one is missing or gone, `make page-moments` computes them anew."""
    view = RaceView if entry["run"]["kind"] == "race" else TrainingView
    assert entry["run"].keys() == field_names(view)
    for moment in entry["moments"]:
        scene = moment["scene"]
        assert scene.keys() == field_names(SceneView)
        for lane in scene["lanes"]:
            assert lane.keys() == field_names(SceneLane)
