"""Tables in terminals and pipes show every cell whole."""

import re

import pytest

from app.cli.terminal import show_table

RUN = "00000000000t1"
HEAD = ("run", "kind", "state", "steps", "result", "began", "name")
ROWS = [
    (
        RUN,
        "experiment",
        "interrupted",
        "1,000 of 2,000 trials",
        "3 of 12 claims hold",
        "2026-10-10 10:10",
        "[b]a name of many words[/b]",
    ),
    (RUN, "race", "finished", "50", "Expected Sarsa", "2026-10-10 10:10", "x" * 40),
]


def table(capsys: pytest.CaptureFixture[str]) -> list[str]:
    show_table("Newest first", HEAD, ROWS, text=(1, 2, 4, 6))
    return capsys.readouterr().out.splitlines()


@pytest.mark.parametrize("columns", [80, 100, 200])
def test_a_table_fits_its_terminal_and_nothing_is_cut(
    columns: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", str(columns))
    lines = table(capsys)
    assert max(map(len, lines)) <= columns
    shown = "".join(lines)
    assert "…" not in shown
    for character in "x[]":
        wanted = sum(cell.count(character) for row in (HEAD, *ROWS) for cell in row)
        assert shown.count(character) == wanted
    assert shown.count(RUN) == 2  # what one copies is never broken
    words = {word for row in ROWS for cell in row[:-1] for word in cell.split()}
    assert words <= set(re.split(r"\s+", "\n".join(lines)))


def test_each_row_is_one_line_in_a_pipe(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv("COLUMNS", raising=False)
    title, head, _, *rows = table(capsys)
    assert title == "Newest first"
    assert tuple(head.split()) == HEAD
    assert [re.split(r"\s{2,}", row.strip()) for row in rows] == [list(row) for row in ROWS]
