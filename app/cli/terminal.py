"""Progress and tables for people; programs get neither."""

import sys
from collections.abc import Sequence
from typing import Any

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    Task,
    TextColumn,
    TimeRemainingColumn,
)
from rich.table import Table
from rich.text import Text


class _Rate(ProgressColumn):
    """How many of something are done a second."""

    def __init__(self, what: str) -> None:
        super().__init__()
        self._what = what

    def render(self, task: Task) -> Text:
        """Nothing until there is a rate."""
        return Text("" if task.speed is None else f"{task.speed:.1f} {self._what}/s")


def progress(what: str | None = None, window_s: float = 30.0) -> Progress:
    """A progress bar on the terminal's error stream; nothing in a pipe.

    Args:
        what: is counted, to show its rate too.
        window_s: over which rate and time left are estimated.
    """
    console = Console(stderr=True)
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        *([] if what is None else [_Rate(what)]),
        TimeRemainingColumn(),
        speed_estimate_period=window_s,
        console=console,
        disable=not console.is_terminal,
        transient=True,
    )


def show_table(
    title: str, head: Sequence[str], rows: Sequence[Sequence[Any]], *, long_names: bool = False
) -> None:
    """A table with a title; all columns but the first are numbers.

    Args:
        title: above it.
        head: names of the columns.
        rows: as many cells each.
        long_names: whether what is in the first column may go on in a further line, rather than
            the numbers.
    """
    table = Table(title=title, title_justify="left")
    for place, name in enumerate(head):
        whole = (place == 0) != long_names
        table.add_column(name, justify="left" if place == 0 else "right", no_wrap=whole)
    for row in rows:
        # As text: in a name, [brackets] would be taken for markup.
        table.add_row(*(Text(str(cell)) for cell in row))
    Console(file=sys.stdout).print(table)
