"""Learning curves and Q-tables as CSV and JSON, streamed in chunks."""

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from typing import Any

import numpy as np

from hexapods.agents.landing_table import LandingRows
from hexapods.agents.table_rows import TableRows
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
    """Yield a table as CSV: state's cells, group and cell of the action, or landing; then both."""
    kind = "landing" if isinstance(table, LandingRows) else "state"
    action = [] if kind == "landing" else ["action_pair", "action_cell"]
    cells = [f"{kind}_{group}" for group in range(table.groups)]
    yield ",".join([*cells, *action, "value", "visits"]) + "\r\n"
    for entries in _chunks(table):
        yield "".join(
            ",".join(
                map(str, (*entry[kind], *entry.get("action", ()), entry["value"], entry["visits"]))
            )
            + "\r\n"
            for entry in entries
        )


def _chunks(table: TableRows | LandingRows) -> Iterator[list[dict[str, Any]]]:
    entries = _entries(table)
    while chunk := list(islice(entries, _VALUES_PER_CHUNK)):
        yield chunk


def _entries(table: TableRows | LandingRows) -> Iterator[dict[str, Any]]:
    """Yield the values of all legal actions in all states, or those of all landings."""
    if isinstance(table, LandingRows):
        for landing, value, visits in table.rows():
            yield {"landing": landing, "value": value, "visits": visits}
        return
    for state, values, counts in table.rows():
        for group, cell in np.argwhere(~np.isnan(values)).tolist():
            value, visits = float(values[group, cell]), int(counts[group, cell])
            yield {"state": state, "action": [group, cell], "value": value, "visits": visits}
