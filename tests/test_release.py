"""What says which version this is: the changelog, and the file by which the software is cited."""

import datetime
import re
from importlib import import_module
from itertools import pairwise
from pathlib import Path
from typing import Any

from packaging.version import Version

from hexapods import __version__

ROOT = Path(__file__).parent.parent
CHANGELOG = (ROOT / "CHANGELOG.md").read_text("utf-8")


def dated_versions() -> list[tuple[Version, datetime.date]]:
    """Return the versions of the changelog with their dates, as the file orders them."""
    headings = re.findall(r"^## \[(\d.*)\] - (\S+)$", CHANGELOG, re.MULTILINE)
    return [(Version(name), datetime.date.fromisoformat(day)) for name, day in headings]


def test_the_newest_version_of_the_changelog_is_the_declared_one() -> None:
    assert dated_versions()[0][0] == Version(__version__)


def test_the_changelog_has_what_is_unreleased_first_and_the_newest_version_next() -> None:
    headings = re.findall(r"^## (.*)$", CHANGELOG, re.MULTILINE)
    assert headings[0] == "[Unreleased]"
    assert len(headings) == 1 + len(dated_versions()), "each other one has a version and a date"
    for (newer, later), (older, earlier) in pairwise(dated_versions()):
        assert newer > older
        assert later >= earlier


def test_each_part_of_a_version_is_named_as_the_others_are() -> None:
    named = set(re.findall(r"^### (.*)$", CHANGELOG, re.MULTILINE))
    kinds = {"Added", "Changed", "Fixed", "Removed", "Security", "Deprecated"}
    assert named <= kinds | {"Changed, so that clients must change with it"}
    for part in re.split(r"^## ", CHANGELOG, flags=re.MULTILINE)[1:]:
        names = re.findall(r"^### (.*)$", part, re.MULTILINE)
        assert len(names) == len(set(names)), part.partition("\n")[0]


def test_the_citation_has_the_version_and_its_date() -> None:
    citation: dict[str, Any] = import_module("yaml").safe_load(
        (ROOT / "CITATION.cff").read_text("utf-8")
    )
    version, day = dated_versions()[0]
    assert (citation["version"], citation["date-released"]) == (str(version), day.isoformat())
