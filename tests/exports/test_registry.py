"""The registry of exports: the document has all of it."""

from pathlib import Path

from hexapods.exports.registry import EXPORTS

ROOT = Path(__file__).parents[2]


def test_the_document_has_a_row_for_each_file() -> None:
    rows = (ROOT / "docs" / "exports.md").read_text().splitlines()
    for name, export in EXPORTS.items():
        for file in export.files:
            command = f"`hexapods runs {name} RUN --out walk.{file.ending}`"
            request = f"`{export.method} /runs/{{id}}/{export.address(name, file)}`"
            needs = "" if file.extra is None else f'`pip install "racing-hexapods[{file.extra}]"` '
            assert f"| {file.title} | {command} | {request} | {needs}|" in rows
