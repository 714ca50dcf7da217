"""Checks of `hexapods doctor` by features that fail: named, and beside all other checks."""

from pathlib import Path

import pytest

from app.cli import data_checks
from app.cli.machine_checks import CheckFailed
from app.installed_features import Catalogue
from app.settings import Settings
from app.storage.database.opening import open_store
from hexapods.domain.errors import InvalidInput
from tests.test_active_features import failing


def test_a_feature_that_cannot_say_its_checks_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(data_checks, "load", lambda without: Catalogue((failing("checks"),)))
    settings = Settings(data=tmp_path)
    checks = data_checks.data_checks(settings)
    assert "database" in checks
    with pytest.raises(CheckFailed, match=r"failing fails in `checks`.*HEXAPODS_WITHOUT=failing"):
        checks["failing"](settings)


def test_a_feature_that_cannot_read_its_rows_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(data_checks, "load", lambda without: Catalogue((failing("read_rows"),)))
    settings = Settings(data=tmp_path)
    with open_store(settings):
        pass
    with pytest.raises(InvalidInput, match="failing fails in `read_rows`"):
        data_checks.data_checks(settings)["rows"](settings)
