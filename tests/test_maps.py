"""The maps of the code are complete: architecture.md, decisions, and docstrings of packages."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
DECISIONS = ROOT / "docs" / "decisions"
RECORDS = sorted(DECISIONS.glob("0*.md"))
PAGES = [ROOT / "docs" / "architecture.md", DECISIONS / "index.md", *RECORDS]
PARTS = ["## Context", "## Choice", "## Consequences"]
MAX_WORDS = 400
_PATH = re.compile(r"`((?:app|docs|hexapods|static|tests)/[\w./-]*)`")
_WITHOUT_MODULES = {"templates", "versions"}
"""Folders whose files are found by others: page templates, and migrations by Alembic."""


PACKAGES = [
    init.parent
    for root in ("app", "hexapods")
    for init in sorted((ROOT / root).rglob("__init__.py"))
    if init.parent.name not in _WITHOUT_MODULES
]


def name_of(path: Path) -> str:
    return str(path.relative_to(ROOT))


@pytest.mark.parametrize("package", PACKAGES, ids=name_of)
def test_the_docstring_of_a_package_names_each_of_its_modules(package: Path) -> None:
    docstring = ast.get_docstring(ast.parse((package / "__init__.py").read_text("utf-8"))) or ""
    modules = {path.stem for path in package.glob("*.py")} - {"__init__", "__main__"}

    assert modules - set(re.findall(r"\w+", docstring)) == set(), "say what each of them is for"


def test_the_architecture_has_each_package() -> None:
    text = (ROOT / "docs" / "architecture.md").read_text("utf-8")
    in_tables = [name_of(path) for path in PACKAGES if len(path.relative_to(ROOT).parts) == 2]

    assert [name for name in in_tables if f"`{name}`" not in text] == [], "a row for each"


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_files_that_are_named_exist(page: Path) -> None:
    named = _PATH.findall(page.read_text("utf-8"))

    assert [path for path in named if not (ROOT / path).exists()] == []


@pytest.mark.parametrize("record", RECORDS, ids=name_of)
def test_a_decision_has_its_parts_on_half_a_page(record: Path) -> None:
    text = record.read_text("utf-8")

    assert [line for line in text.splitlines() if line.startswith("## ")] == PARTS
    assert len(text.split()) <= MAX_WORDS


def test_decisions_are_numbered_and_listed_in_their_order() -> None:
    listed = re.findall(
        r"^0\d{3}-[\w-]+$", (DECISIONS / "index.md").read_text("utf-8"), re.MULTILINE
    )

    assert listed == [record.stem for record in RECORDS]
    assert [int(name[:4]) for name in listed] == list(range(1, len(listed) + 1))
