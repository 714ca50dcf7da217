"""Learning curves and Q-tables as CSV and JSON, streamed in chunks."""

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from typing import Any

from hexapods.agents.landing_table import LandingRows
from hexapods.agents.table_rows import TableRows, flat_entry
from hexapods.domain.grid import FootGrid

_VALUES_PER_CHUNK = 500
"""Action values per chunk, about 30 kB of text, which stay in memory while a client reads them."""


def as_csv(rows: Sequence[Mapping[str, Any]]) -> bytes:
    """Return a learning curve as CSV with the columns step, distance_m, epsilon."""
    columns = ("step", "distance_m", "epsilon")
    lines = [",".join(columns), *(",".join(_cell(row[c]) for c in columns) for row in rows)]
    return "".join(f"{line}\r\n" for line in lines).encode()


def _cell(number: float) -> str:
    """Return a number as text; empty if it is not finite."""
    return str(number) if math.isfinite(number) else ""


def table_as_json(table: TableRows | LandingRows, meta: Mapping[str, Any]) -> Iterator[str]:
    """Yield a table as JSON, in chunks; large tables have millions of values."""
    grid = FootGrid(meta["grid_side_m"], meta["divisions"])
    head = {
        "gait": meta["gait"],
        "divisions": meta["divisions"],
        "grid_side_m": meta["grid_side_m"],
        "cells": grid.cells.tolist(),
    }
    yield json.dumps(head)[:-1] + ', "values": ['
    separator = ""
    for entries in _chunks(table):
        yield separator + ",\n".join(json.dumps(entry, allow_nan=False) for entry in entries)
        separator = ",\n"
    yield "]}\n"


def table_as_csv(table: TableRows | LandingRows) -> Iterator[str]:
    """Yield a table as CSV: cells of the state with pair and cell of the action, or of the landing.

    Then come value and visits.
    """
    is_first = True
    for entries in _chunks(table):
        rows = [flat_entry(entry) for entry in entries]
        head = ",".join(rows[0]) + "\r\n" if is_first else ""
        is_first = False
        yield head + "".join(",".join(map(str, row.values())) + "\r\n" for row in rows)


def _chunks(table: TableRows | LandingRows) -> Iterator[list[Mapping[str, Any]]]:
    entries = table.entries()
    while chunk := list(islice(entries, _VALUES_PER_CHUNK)):
        yield chunk
