"""Learning curves and Q-tables as CSV and JSON, streamed in chunks."""

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Protocol

import numpy as np

from hexapods.domain.grid import FootGrid
from hexapods.domain.types import Cells, FloatArray

_VALUES_PER_CHUNK = 500
"""Action values per chunk, about 30 kB of text, which stay in memory while a client reads them."""


class Rows(Protocol):
    """A Q-table whose rows can be iterated, in memory or in its file."""

    groups: int

    def rows(self) -> Iterator[tuple[Cells, FloatArray, FloatArray]]:
        """Yield (state, values, visits) in order; arrays (groups, cells), NaN where illegal."""


def as_csv(rows: Sequence[Mapping[str, Any]]) -> bytes:
    """Return a learning curve as CSV with the columns step, distance_m, epsilon."""
    columns = ("step", "distance_m", "epsilon")
    lines = [",".join(columns), *(",".join(_cell(row[c]) for c in columns) for row in rows)]
    return "".join(f"{line}\r\n" for line in lines).encode()


def _cell(number: float) -> str:
    """Return a number as text; empty if it is not finite."""
    return str(number) if math.isfinite(number) else ""


def table_as_json(table: Rows, meta: Mapping[str, Any]) -> Iterator[str]:
    """Yield the values of all legal actions as JSON, in chunks; large tables have millions."""
    grid = FootGrid(meta["grid_side_m"], meta["divisions"])
    head = {
        "gait": meta["gait"],
        "divisions": meta["divisions"],
        "grid_side_m": meta["grid_side_m"],
        "cells": grid.cells.tolist(),
    }
    yield json.dumps(head)[:-1] + ', "values": ['
    separator = ""
    for rows in _chunks(table):
        entries = (
            json.dumps(
                {"state": state, "action": [group, cell], "value": value, "visits": visits},
                allow_nan=False,
            )
            for state, group, cell, value, visits in rows
        )
        yield separator + ",\n".join(entries)
        separator = ",\n"
    yield "]}\n"


def table_as_csv(table: Rows) -> Iterator[str]:
    """Yield the values of all legal actions as CSV: state's cells, group, cell, value, visits."""
    cells = [f"state_{group}" for group in range(table.groups)]
    yield ",".join([*cells, "action_pair", "action_cell", "value", "visits"]) + "\r\n"
    for rows in _chunks(table):
        yield "".join(
            ",".join(map(str, (*state, group, cell, value, visits))) + "\r\n"
            for state, group, cell, value, visits in rows
        )


_Row = tuple[tuple[int, ...], int, int, float, int]


def _chunks(table: Rows) -> Iterator[list[_Row]]:
    chunk: list[_Row] = []
    for state, values, visits in table.rows():
        for group, cell in np.argwhere(~np.isnan(values)).tolist():
            value, count = float(values[group, cell]), int(visits[group, cell])
            chunk.append((state, group, cell, value, count))
        if len(chunk) >= _VALUES_PER_CHUNK:
            yield chunk
            chunk = []
    if chunk:
        yield chunk
