"""The documentation's programs, as a reader would copy them."""

import re
from collections.abc import Iterator, Mapping
from pathlib import Path

import nbformat

from tests.cli.running import ROOT

DOCS = ROOT / "docs"
_BLOCK = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def blocks(page: Path) -> list[str]:
    """Return the Python programs of a page; those after the first of python.md begin as it does."""
    programs = _BLOCK.findall(page.read_text("utf-8"))
    begin = "import hexapods as hx\n" if page.name == "python.md" else ""
    return [begin * (number > 0) + block for number, block in enumerate(programs)]


def programs() -> Mapping[str, str]:
    """Return every program of README.md, docs/, its examples and its notebooks, by a file name."""
    return dict(_programs())


def _programs() -> Iterator[tuple[str, str]]:
    for page in (ROOT / "README.md", *sorted(DOCS.glob("*.md"))):
        for number, block in enumerate(blocks(page)):
            yield f"{page.stem.lower().replace('-', '_')}_{number}.py", block
    for example in sorted((DOCS / "examples").glob("*.py")):
        yield example.name, example.read_text("utf-8")
    for notebook in sorted((DOCS / "notebooks").glob("*.ipynb")):
        cells = nbformat.read(notebook, as_version=4).cells  # type: ignore[no-untyped-call]
        code = [cell["source"] for cell in cells if cell["cell_type"] == "code"]
        yield f"{notebook.stem}_notebook.py", "\n\n".join(code)
