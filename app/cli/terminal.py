"""Progress and tables for people; programs get neither."""

import sys
from collections.abc import Sequence
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text


def progress() -> Progress:
    """A progress bar on the terminal's error stream; nothing in a pipe."""
    console = Console(stderr=True)
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
        console=console,
        disable=not console.is_terminal,
        transient=True,
    )


def show_table(title: str, head: Sequence[str], rows: Sequence[Sequence[Any]]) -> None:
    """A table with a title; all columns but the first are numbers."""
    table = Table(title=title, title_justify="left")
    for place, name in enumerate(head):
        table.add_column(name, justify="left" if place == 0 else "right", no_wrap=place == 0)
    for row in rows:
        # As text: in a name, [brackets] would be taken for markup.
        table.add_row(*(Text(str(cell)) for cell in row))
    Console(file=sys.stdout).print(table)
