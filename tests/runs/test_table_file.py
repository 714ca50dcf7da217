"""Reading a Q-table from its file by row: equals the table; invalid files are refused."""

import io
import json
from dataclasses import replace
from typing import Any

import numpy as np
import psutil
import pytest

from hexapods.agents.q_table import QTable
from hexapods.agents.table_rows import TableRows
from hexapods.assembly import build_learner
from hexapods.domain.errors import DamagedFile, OtherFormat, TableMismatch
from hexapods.runs.config import TrainingConfig, training_config
from hexapods.runs.table_file import TableFile
from hexapods.runs.tables import Checkpoint, snapshot, to_bytes

CONFIG = training_config(gait="left-right-origin", simulator="kinematic", steps=10)


def opened(data: bytes) -> TableFile:
    return TableFile(io.BytesIO(data), "it")


def with_values(table: QTable, config: TrainingConfig) -> Checkpoint:
    checkpoint = snapshot(build_learner(config), config)
    agent = {f"agent.{name}": array for name, array in table.dump().items()}
    return Checkpoint(checkpoint.meta, {**checkpoint.arrays, **agent})


def filled(divisions: int, states: float, seed: int = 0) -> tuple[QTable, Checkpoint]:
    """Create a table with values in a share of its states, and its file."""
    config = replace(CONFIG, divisions=divisions)
    table, chance = QTable(3, len(config.grid)), np.random.default_rng(seed)
    for state in chance.permutation(table.states)[: int(states * table.states)].tolist():
        q, n = table.row(state)
        columns = chance.integers(table.actions, size=7)
        q[columns], n[columns] = chance.normal(size=7), chance.integers(1, 1000, size=7)
    return table, with_values(table, config)


@pytest.mark.parametrize(
    ("divisions", "states"), [(2, 0.0), (2, 0.4), (2, 1.0), (3, 0.01), (3, 0.5), (3, 1.0)]
)
def test_rows_equal_those_of_the_table(divisions: int, states: float) -> None:
    table, checkpoint = filled(divisions, states)
    read = opened(to_bytes(checkpoint))

    assert (read.table.groups, read.table.cells) == (table.groups, table.cells)
    assert dict(read.meta) == dict(checkpoint.meta)
    assert isinstance(read.table, TableRows)
    rows = list(read.table.rows())
    assert len(rows) == table.states
    for (state, values, visits), (again, expected, counts) in zip(rows, table.rows(), strict=True):
        assert state == again
        assert np.array_equal(values, expected, equal_nan=True)
        assert np.array_equal(visits, counts, equal_nan=True)


def test_reading_the_largest_table_takes_constant_memory() -> None:
    table, checkpoint = filled(8, 0.05)
    data = to_bytes(checkpoint)
    rows = opened(data).table.rows()
    next(rows)
    before = psutil.Process().memory_info().rss
    for _ in range(20_000):
        next(rows)

    assert table.size > 50_000_000
    assert psutil.Process().memory_info().rss - before < 5_000_000


def changed(**changes: Any) -> bytes:
    _, checkpoint = filled(2, 0.4)
    arrays = {**checkpoint.arrays, **{f"agent.{k}": v for k, v in changes.items()}}
    return to_bytes(Checkpoint(checkpoint.meta, {k: v for k, v in arrays.items() if v is not None}))


@pytest.mark.parametrize(
    ("changes", "error", "message"),
    [
        ({"where": None}, TableMismatch, "keeps no Q-table"),
        ({"q": np.zeros(3)}, TableMismatch, "do not fit together"),
        ({"q": None}, DamagedFile, "it is not a Q-table"),
        ({"n": np.zeros((2, 2), np.uint32)}, DamagedFile, "another shape"),
    ],
)
def test_invalid_file_is_refused(
    changes: dict[str, Any], error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        opened(changed(**changes))


@pytest.mark.parametrize("length", [0, 10, 100, -30])
def test_truncated_file_is_refused(length: int) -> None:
    with pytest.raises(DamagedFile, match="not a Q-table"):
        opened(changed()[:length])


def test_values_out_of_order_are_refused() -> None:
    table, checkpoint = filled(3, 1.0)
    where = np.sort(np.concatenate([table.dump()["where"]])).copy()
    where[-1] = 0
    arrays = {**checkpoint.arrays, "agent.where": where}

    with pytest.raises(TableMismatch, match="rising order"):
        list(opened(to_bytes(Checkpoint(checkpoint.meta, arrays))).table.rows())


@pytest.mark.parametrize("version", [1, 3])
def test_another_format_version_is_refused(version: int) -> None:
    _, checkpoint = filled(2, 0.4)
    meta = {**json.loads(json.dumps(dict(checkpoint.meta))), "format": version}

    with pytest.raises(OtherFormat, match=f"has format {version}; this version reads 2 alone"):
        opened(to_bytes(Checkpoint(meta, checkpoint.arrays)))
