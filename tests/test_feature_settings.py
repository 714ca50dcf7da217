"""Settings of features of other packages: read, checked, left out, and light to import."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from app.feature_settings import installed_settings
from app.settings import read_settings, remove_secrets
from hexapods.domain.errors import InvalidInput

DIARY = """
from dataclasses import dataclass
from typing import ClassVar

from app.feature_settings import FeatureSettings
from app.setting_fields import choice, names, switch, text, whole_number
from hexapods.domain.errors import InvalidInput


def check_reader(variable, name):
    if name == "nobody":
        raise InvalidInput(f"{variable} must be names of readers, not {name!r}")


@dataclass(frozen=True, kw_only=True)
class DiarySettings(FeatureSettings):
    feature: ClassVar[str] = "diary"
    diary: bool = switch(option="write a diary")
    diary_lines: int = whole_number(10, 1, 99, unit=" of lines")
    diary_ink: str = choice("blue", ("blue", "red"))
    diary_key: str | None = text(None, is_secret=True)
    diary_readers: tuple[str, ...] = names(check_reader, ignores_case=True)

    def stricter_defaults(self):
        return {"max_viewers": 7, "diary_lines": 3} if self.diary else {}

    def check(self, settings):
        if self.diary and settings.spectators == "public":
            raise InvalidInput("a diary is not for the public")


SETTINGS = DiarySettings
"""
ON = {"HEXAPODS_DIARY": "1", "HEXAPODS_SPECTATORS": "token"}


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    """Install a package whose feature `diary` has settings, by the text of their module."""

    def installed(text: str) -> None:
        about = tmp_path / "hexapods_diary-1.0.dist-info"
        about.mkdir()
        (tmp_path / "hexapods_diary.py").write_text(text)
        (about / "METADATA").write_text("Metadata-Version: 2.1\nName: hexapods-diary\nVersion: 1\n")
        (about / "entry_points.txt").write_text("[hexapods.settings]\ndiary = hexapods_diary\n")
        monkeypatch.syspath_prepend(str(tmp_path))
        monkeypatch.delitem(sys.modules, "hexapods_diary", raising=False)

    return installed


@pytest.fixture
def diary(install: Callable[[str], None]) -> None:
    install(DIARY)


@pytest.mark.usefixtures("diary")
def test_settings_of_features_are_read_like_those_of_the_core() -> None:
    settings = read_settings({**ON, "HEXAPODS_DIARY_INK": "red"}, diary_lines=40)
    kind = next(kind for kind in installed_settings() if kind.feature == "diary")
    assert settings.of(kind) == kind(diary=True, diary_lines=40, diary_ink="red")  # type: ignore[call-arg]
    assert settings.max_viewers == 7
    readers = read_settings({"HEXAPODS_DIARY_READERS": "Ann, BOB,"}).of(kind)
    assert readers == kind(diary_readers=("ann", "bob"))  # type: ignore[call-arg]
    assert settings.of(kind) != read_settings(ON).of(kind) == kind(diary=True, diary_lines=3)  # type: ignore[call-arg]
    assert read_settings({}).of(kind) == kind()
    assert read_settings({**ON, "HEXAPODS_MAX_VIEWERS": "9"}).max_viewers == 9


@pytest.mark.usefixtures("diary")
@pytest.mark.parametrize(
    ("environ", "message"),
    [
        ({"HEXAPODS_DIARY": "1"}, "a diary is not for the public"),
        ({"HEXAPODS_DIARY": "so"}, "HEXAPODS_DIARY must be 1 or 0, not 'so'"),
        ({"HEXAPODS_DIARY_LINES": "few"}, "HEXAPODS_DIARY_LINES must be a whole number of lines"),
        ({"HEXAPODS_DIARY_LINES": "100"}, "HEXAPODS_DIARY_LINES must be from 1 to 99, not 100"),
        ({"HEXAPODS_DIARY_READERS": "Ann, Nobody"}, "HEXAPODS_DIARY_READERS.*not 'nobody'"),
        ({"HEXAPODS_DIARY_INK": "green"}, "HEXAPODS_DIARY_INK.*green.*blue, red"),
        (
            {**ON, "HEXAPODS_WITHOUT": "diary"},
            "HEXAPODS_DIARY is on, and HEXAPODS_WITHOUT leaves the diary out; take one of both",
        ),
    ],
)
def test_invalid_settings_of_a_feature_are_refused(environ: dict[str, str], message: str) -> None:
    with pytest.raises(InvalidInput, match=message):
        read_settings(environ)


@pytest.mark.usefixtures("diary")
def test_their_secrets_are_removed_too(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HEXAPODS_DIARY_KEY", "sesame")
    kind = next(kind for kind in installed_settings() if kind.feature == "diary")
    assert "sesame" not in repr(read_settings())
    assert read_settings().of(kind) == kind(diary_key="sesame")  # type: ignore[call-arg]
    remove_secrets()
    assert read_settings().of(kind) == kind()


def test_a_setting_of_the_core_cannot_be_replaced(install: Callable[[str], None]) -> None:
    install(DIARY.replace("diary_ink", "port"))
    with pytest.raises(InvalidInput, match="the feature diary has the setting HEXAPODS_PORT"):
        read_settings({})
    assert read_settings({"HEXAPODS_WITHOUT": "diary"}).port == 8000


@pytest.mark.parametrize(
    "text", ["import nothing_of_this_name", "SETTINGS = dict", DIARY.replace('"diary"', '"notes"')]
)
def test_settings_that_cannot_be_used_are_named(install: Callable[[str], None], text: str) -> None:
    install(text)
    with pytest.raises(
        InvalidInput, match=r"`settings` of the feature diary (cannot be imported|needs SETTINGS)"
    ):
        read_settings({})
    assert read_settings({"HEXAPODS_WITHOUT": "diary"}).without == ("diary",)


def test_reading_them_imports_no_server() -> None:
    code = (
        "import sys; from app.settings import read_settings; read_settings({}); "
        "print(sorted({'fastapi', 'starlette', 'sqlalchemy', 'numpy'} & sys.modules.keys()))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"
