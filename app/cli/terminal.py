"""Progress bars and tables for terminals."""

import os
import re
import sys
import textwrap
from collections.abc import Collection, Iterable, Sequence
from typing import Any, Literal

from rich import box
from rich.cells import cell_len
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

from hexapods.agents.appearance import name_of, title_of
from hexapods.experiments.cluster import ClusterSpec
from hexapods.machine import cores
from hexapods.races import Race
from hexapods.runs.clocks import CLOCK_TITLES, Clock
from hexapods.runs.lane import PLANNING_MODEL_TITLES, plans_with

RATE_WINDOW_S = 300.0
"""Time over which a rate is averaged: work of one command takes a second to half a minute."""
_BETWEEN = 2
"""Width of what is between two columns."""
_INDENT = 2
"""Of each further line of a cell of text, in a column with room for it."""
_MIN_TEXT = 8
"""A column of text is not narrower, as long as its text is wider."""


class _Rate(ProgressColumn):
    """Progress column with the rate per second."""

    def __init__(self, what: str) -> None:
        super().__init__()
        self._what = what

    def render(self, task: Task) -> Text:
        """Return the rate as text; empty until it is known."""
        return Text("" if task.speed is None else f"{task.speed:.1f} {self._what}/s")


def progress(what: str | None = None, window_s: float = 30.0) -> Progress:
    """Return a progress bar on standard error; disabled if that is no terminal.

    Args:
        what: name of the counted items, to show their rate; None for no rate.
        window_s: time over which rate and remaining time are estimated [s].
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
    title: str, head: Sequence[str], rows: Sequence[Sequence[Any]], *, text: Collection[int] = (0,)
) -> None:
    """Print a table of which nothing is cut, however narrow the terminal is.

    Cells wrap between words, not at no-break spaces. In a pipe each row is one line, unless
    `COLUMNS` says how wide a line is.

    Args:
        title: title above the table.
        head: names of the columns.
        rows: cells of each row, as many as columns.
        text: numbers of the columns of text, which are left-aligned; where there is too little
            room they break within words. The others are right-aligned, for numbers.
    """
    console = Console(file=sys.stdout)
    columns = list(zip(*(head, *([str(cell) for cell in row] for row in rows)), strict=True))
    widths = [_longest(cells, "\n") for cells in columns]
    if console.is_terminal or "COLUMNS" in os.environ:
        room = console.width - _BETWEEN * (len(head) - 1)
        words = [_longest(cells, " ", "\n") for cells in columns]
        widths = _narrowed(widths, words, room)
        least = [min(_MIN_TEXT, word) if n in text else word for n, word in enumerate(words)]
        widths = _narrowed(widths, least, room)
    table = Table(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False, collapse_padding=True)
    for n, (name, width) in enumerate(zip(head, widths, strict=True)):
        side: Literal["left", "right"] = "left" if n in text else "right"
        table.add_column(name, justify=side, width=width, overflow="fold", vertical="top")
    for row in rows:
        # As `Text`, as Rich would parse [brackets] in a name as markup.
        table.add_row(
            *(
                Text(_wrapped(str(cell), width) if n in text else str(cell))
                for n, (cell, width) in enumerate(zip(row, widths, strict=True))
            )
        )
    print(title)
    # Narrower than its widths it would cut them.
    Console(file=sys.stdout, width=sum(widths) + _BETWEEN * len(head)).print(table)


def _wrapped(cell: str, width: int) -> str:
    """Wrap a cell at spaces, each further line indented; Rich would also at no-break spaces."""
    hanging = _INDENT if width > _MIN_TEXT * 2 else 0
    wrapped = []
    for line in cell.split("\n"):
        indent = " " * (hanging + len(line) - len(line.lstrip(" ")))
        wrapped += textwrap.wrap(line, width, subsequent_indent=indent, break_on_hyphens=False)
    return "\n".join(wrapped)


def _longest(cells: Iterable[str], *separators: str) -> int:
    """Return the width of the widest part of some cells, in columns of the terminal."""
    parts = re.compile("|".join(separators))
    return max(cell_len(word) for cell in cells for word in parts.split(cell))


def _narrowed(widths: Sequence[int], least: Sequence[int], room: int) -> list[int]:
    """Return widths that add up to the room, the widest narrowed first, but none below its least.

    They add up to more if the least do.
    """
    narrowed = list(widths)
    while sum(narrowed) > room:
        narrowable = [n for n, width in enumerate(narrowed) if width > least[n]]
        if not narrowable:
            break
        narrowed[max(narrowable, key=lambda n: (narrowed[n], n))] -= 1
    return narrowed


def show_lanes(race: Race, clock: Clock) -> None:
    """Print the result of a race as a table, ranked under a clock, and the best known distance.

    A race that ended before its time-out has no ranking. Why lanes failed is told below the table,
    where a narrow terminal does not break it apart.
    """
    rows, failures = [], []
    for standing in race.standings_under(clock):
        lane_config, lane = race.config.lanes[standing.lane], race.result.lanes[standing.lane]
        name = name_of(lane_config.agent, lane_config.settings, lane_config.keep_learning)
        model = plans_with(lane_config, race.config)
        name += f"\n   plans with the {PLANNING_MODEL_TITLES[model]}" if model else ""
        finished_m, total_m = standing.finished_distance_m, standing.total_distance_m
        if lane.failure is not None:
            failures.append(f"{title_of(lane_config.agent)} failed: {lane.failure}")
        rows.append(
            (
                name if standing.rank is None else f"{standing.rank}. {name}",
                "–" if finished_m is None else f"{finished_m:.2f} m",
                ("–" if lane.failure is None else "failed")
                if total_m is None
                else f"{total_m:.2f} m",
                f"{standing.elapsed_s:.1f} s",
                f"{1000 * lane.decision_s / max(1, lane.steps):.1f} ms",
                f"{lane.simulated_transitions:,}",
            )
        )
    is_ranked = any(standing.rank is not None for standing in race.standings_under(clock))
    title = "Ranked at time-out" if is_ranked else "No ranking: no lane used all its steps"
    head = ("lane", "at time-out", "total", "time", "a decision", "simulated transitions")
    show_table(f"{title}, {CLOCK_TITLES[clock]}", head, rows)
    for sentence in failures:
        print(sentence)
    print(f"SHA-256 of its recording: {race.recording_sha256}")
    if race.best_known_m is not None:
        print(f"Best known, total: {race.best_known_m:.2f} m")


def workers_text(cluster: ClusterSpec) -> str:
    """Describe where work is done: `on 2 workers`."""
    if cluster.scheduler is not None:
        return f"on the cluster of {cluster.scheduler}"
    workers = cluster.workers or cores()
    return f"on {workers} worker{'s' if workers > 1 else ''}"


def discard(_: str) -> None:
    """Print nothing; used with `--json`."""
