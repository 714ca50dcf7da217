"""The dashboard and the models are found in a checkout and in an installed package."""

from pathlib import Path

import pytest

from hexapods import assets

CHECKOUT = Path(__file__).parent.parent


def test_a_checkout_has_them_at_its_top_level() -> None:
    assert assets.static_dir() == CHECKOUT / "static"
    assert assets.models_dir() == CHECKOUT / "models"


def test_an_installed_package_prefers_its_own(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    package = tmp_path / "hexapods"
    (package / "_static").mkdir(parents=True)
    (tmp_path / "static").mkdir()
    monkeypatch.setattr(assets, "_PACKAGE", package)

    assert assets.static_dir() == package / "_static"


def test_a_broken_installation_says_so(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(assets, "_PACKAGE", tmp_path / "hexapods")

    with pytest.raises(FileNotFoundError, match="incomplete"):
        assets.models_dir()
