"""Progress bars and tables for terminals."""

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

from app.agents.appearance import name_of
from app.runs.best_known import best_known_in_race_m
from app.runs.lane import PLANNING_MODEL_TITLES, plans_with
from app.runs.race_config import RaceConfig


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
    title: str, head: Sequence[str], rows: Sequence[Sequence[Any]], *, long_names: bool = False
) -> None:
    """Print a table; all columns but the first are right-aligned, for numbers.

    Args:
        title: title above the table.
        head: names of the columns.
        rows: cells of each row, as many as columns.
        long_names: whether to wrap the first column rather than the others.
    """
    table = Table(title=title, title_justify="left")
    for place, name in enumerate(head):
        whole = (place == 0) != long_names
        table.add_column(name, justify="left" if place == 0 else "right", no_wrap=whole)
    for row in rows:
        # As `Text`, as Rich would parse [brackets] in a name as markup.
        table.add_row(*(Text(str(cell)) for cell in row))
    Console(file=sys.stdout).print(table)


def show_lanes(config: RaceConfig, result: dict[str, Any], clock: str) -> None:
    """Print the result of a race as a table, ranked under a clock, and the best known distance."""
    rows = []
    lanes = zip(config.lanes, result["lanes"], strict=True)
    for own, lane in sorted(lanes, key=lambda both: both[1]["clocks"][clock]["rank"]):
        name = name_of(own.agent, own.settings, own.keep_learning, title=own.agent)
        known = plans_with(own, config)
        name += f"\n   plans with the {PLANNING_MODEL_TITLES[known]}" if known else ""
        timed, total = lane["clocks"][clock], lane["total_distance_m"]
        rows.append(
            (
                f"{timed['rank']}. {name}",
                f"{timed['finished_distance_m']:.2f} m",
                lane["failure"] if total is None else f"{total:.2f} m",
                f"{timed['elapsed_s']:.1f} s",
                f"{1000 * lane['decision_s'] / max(1, lane['steps']):.1f} ms",
                f"{lane['simulated_transitions']:,}",
            )
        )
    head = ("lane", "at time-out", "in all", "time", "a decision", "simulated transitions")
    show_table(f"Ranked at time-out, {clock} clock", head, rows)
    best_m = best_known_in_race_m(config)
    if best_m is not None:
        print(f"Best known, in all: {best_m:.2f} m")
