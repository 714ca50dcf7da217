"""What `make release-missing` asks for before a version is published."""

from pathlib import Path

import pytest

from tests.release_check import ROOT, missing

DIGEST = f"sha256:{'0a' * 32}"


@pytest.fixture
def ready(tmp_path: Path) -> Path:
    """A repository of which nothing is missing."""
    (tmp_path / "hexapods").mkdir()
    (tmp_path / "hexapods" / "version.py").write_text('__version__ = "1.2.0"\n')
    (tmp_path / "CHANGELOG.md").write_text(
        "# Changelog\n\n## [Unreleased]\n\n## [1.2.0] - 2026-01-02\n\n### Added\n\n- A robot.\n"
    )
    (tmp_path / "CITATION.cff").write_text(
        'version: 1.2.0\nrepository-code: "https://forge.org/someone/hexapods"\n'
    )
    (tmp_path / "Dockerfile").write_text(
        f"FROM python:3.13-slim@{DIGEST} AS build\nFROM python:3.13-slim@{DIGEST}\n"
    )
    return tmp_path


def change(root: Path, name: str, old: str, new: str) -> None:
    text = (root / name).read_text()
    assert old in text
    (root / name).write_text(text.replace(old, new))


def test_nothing_is_missing_of_a_version_that_is_ready(ready: Path) -> None:
    assert list(missing(ready)) == []
    assert list(missing(ready, "v1.2.0")) == []


@pytest.mark.parametrize("tag", ["1.2.0", "v1.2", "v1.2.1", ""])
def test_a_tag_of_another_version_is_refused_with_the_right_one(ready: Path, tag: str) -> None:
    [sentence] = missing(ready, tag)
    assert sentence.endswith("tag it v1.2.0.")


@pytest.mark.parametrize(
    ("name", "old", "new", "asked_for"),
    [
        ("CITATION.cff", "repository-code", "url", "repository-code"),
        ("CITATION.cff", "https://forge.org/someone/hexapods", "", "repository-code"),
        ("CITATION.cff", "1.2.0", "1.1.0", "has version 1.1.0, not 1.2.0"),
        ("Dockerfile", f"@{DIGEST}", "", "imagetools inspect python:3.13-slim --format '{{.Man"),
        ("Dockerfile", "0a", "0", "has no digest"),
        (
            "CHANGELOG.md",
            "[Unreleased]\n",
            "[Unreleased]\n\n### Fixed\n\n- A leg.\n",
            "a new version",
        ),
        ("CHANGELOG.md", " - 2026-01-02", "", "with its date"),
        ("CHANGELOG.md", "1.2.0", "1.1.0", "begins with Unreleased, 1.1.0"),
        ("CHANGELOG.md", "## ", "### ", "begins with no version"),
    ],
)
def test_each_thing_that_is_missing_is_asked_for(
    ready: Path, name: str, old: str, new: str, asked_for: str
) -> None:
    change(ready, name, old, new)
    [sentence] = missing(ready)
    assert asked_for in sentence


def test_the_repository_is_complete_but_for_what_its_owner_alone_knows() -> None:
    asked_for = ("repository-code", "has no digest", "below [Unreleased]")
    for sentence in missing(ROOT):
        assert any(text in sentence for text in asked_for), sentence
