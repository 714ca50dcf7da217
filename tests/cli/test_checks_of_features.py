"""Check of `hexapods doctor` on the rows of a feature that fails."""

from pathlib import Path

import pytest

from app.cli import data_checks
from app.installed_features import Catalogue
from app.settings import Settings
from app.storage.database.opening import open_store
from hexapods.domain.errors import InvalidInput
from tests.test_active_features import failing


def test_a_feature_that_cannot_read_its_rows_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(data_checks, "load", lambda without: Catalogue((failing("read_rows"),)))
    settings = Settings(data=tmp_path)
    with open_store(settings):
        pass
    with pytest.raises(InvalidInput, match="failing fails in `read_rows`"):
        data_checks.CHECKS["data"](settings)
