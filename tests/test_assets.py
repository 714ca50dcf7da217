"""The dashboard and the models are found in a checkout and travel in the wheel."""

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from app import assets

CHECKOUT = Path(__file__).parent.parent


def test_a_checkout_has_them_at_its_top_level() -> None:
    assert assets.static_dir() == CHECKOUT / "static"
    assert assets.models_dir() == CHECKOUT / "models"


def test_an_installed_package_prefers_its_own(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    package = tmp_path / "app"
    (package / "_static").mkdir(parents=True)
    (tmp_path / "static").mkdir()
    monkeypatch.setattr(assets, "_PACKAGE", package)

    assert assets.static_dir() == package / "_static"


def test_a_broken_installation_says_so(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(assets, "_PACKAGE", tmp_path / "app")

    with pytest.raises(FileNotFoundError, match="incomplete"):
        assets.models_dir()


def test_the_wheel_carries_them(tmp_path: Path) -> None:
    build = [sys.executable, "-m", "hatchling", "build", "--target", "wheel", "-d", str(tmp_path)]
    subprocess.run(build, cwd=CHECKOUT, check=True, capture_output=True)

    [wheel] = tmp_path.glob("*.whl")
    packed = set(zipfile.ZipFile(wheel).namelist())

    for folder in ("static", "models"):
        files = [path for path in (CHECKOUT / folder).rglob("*") if path.is_file()]
        expected = {f"app/_{path.relative_to(CHECKOUT).as_posix()}" for path in files}
        assert expected <= packed
    assert not {name for name in packed if name.startswith(("static/", "models/", "tests/"))}
