"""Clean-up of what other features keep: all are asked, and none of them ends it."""

from collections.abc import Iterable
from datetime import datetime
from pathlib import Path

import pytest

from app import server
from app.feature import DeleteRuns, Feature
from app.features.demo import expiry
from app.features.demo.settings import DemoSettings
from app.installed_features import Catalogue, load
from app.settings import Settings
from tests.api.conftest import running
from tests.jobs.waiting import wait_until


def test_a_feature_of_another_package_is_asked_again_and_again_whatever_it_raises(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    times: list[datetime] = []

    class Diary(Feature):
        name = "diary"

        def delete_before(self, time: datetime, delete_runs: DeleteRuns) -> Iterable[str]:
            del delete_runs
            times.append(time)
            if len(times) == 1:
                raise RuntimeError("out of order")
            return ["page"]

        async def forget(self, names: Iterable[str]) -> None:
            if list(names):
                raise RuntimeError("out of order")

    monkeypatch.setattr(expiry, "EVERY_S", 0.01)
    monkeypatch.setattr(server, "load", lambda without: Catalogue((*load(without).classes, Diary)))
    settings = Settings(
        data=tmp_path, token="a-token-for-tests", features=(DemoSettings(demo=True),)
    )
    with running(settings):
        wait_until(lambda: len(times) > 3)
