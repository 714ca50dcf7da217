"""Learning curves and Q-tables as CSV and JSON, row by row."""

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Protocol

import numpy as np

from app.domain.grid import FootGrid
from app.domain.types import Cells, FloatArray

_VALUES_A_CHUNK = 500
"""Some 30 kB of text: it is held while a client takes it."""


class Rows(Protocol):
    """A Q-table, in memory or in its file."""

    pairs: int

    def rows(self) -> Iterator[tuple[Cells, FloatArray, FloatArray]]:
        """Every state in order with its values and visits, (pairs, cells), NaN where illegal."""


def as_csv(rows: Sequence[Mapping[str, Any]]) -> bytes:
    """A curve as CSV: step, distance_m, epsilon."""
    columns = ("step", "distance_m", "epsilon")
    lines = [",".join(columns), *(",".join(_cell(row[c]) for c in columns) for row in rows)]
    return "".join(f"{line}\r\n" for line in lines).encode()


def _cell(number: float) -> str:
    """Empty where there is no number."""
    return str(number) if math.isfinite(number) else ""


def table_as_json(table: Rows, meta: Mapping[str, Any]) -> Iterator[str]:
    """The values of all legal actions, in chunks: large tables have millions."""
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
                {"state": state, "action": [pair, cell], "value": value, "visits": visits},
                allow_nan=False,
            )
            for state, pair, cell, value, visits in rows
        )
        yield separator + ",\n".join(entries)
        separator = ",\n"
    yield "]}\n"


def table_as_csv(table: Rows) -> Iterator[str]:
    """The same as CSV: the state's cells, pair, cell, value, visits."""
    cells = [f"state_{pair}" for pair in range(table.pairs)]
    yield ",".join([*cells, "action_pair", "action_cell", "value", "visits"]) + "\r\n"
    for rows in _chunks(table):
        yield "".join(
            ",".join(map(str, (*state, pair, cell, value, visits))) + "\r\n"
            for state, pair, cell, value, visits in rows
        )


_Row = tuple[tuple[int, ...], int, int, float, int]


def _chunks(table: Rows) -> Iterator[list[_Row]]:
    chunk: list[_Row] = []
    for state, values, visits in table.rows():
        for pair, cell in np.argwhere(~np.isnan(values)).tolist():
            value, times = float(values[pair, cell]), int(visits[pair, cell])
            chunk.append((state, pair, cell, value, times))
        if len(chunk) >= _VALUES_A_CHUNK:
            yield chunk
            chunk = []
    if chunk:
        yield chunk
