"""Random-access reader of a Q-table file: reads row by row, in constant memory."""

import json
from collections.abc import Iterator, Mapping
from typing import IO, Any

from hexapods.agents.landing_table import LANDING_ARRAYS, LandingRows, check_landings
from hexapods.agents.q_table import check_size
from hexapods.agents.table_rows import VALUES_AT_ONCE, Chunk, TableRows
from hexapods.domain.checks import check_format
from hexapods.domain.errors import DamagedFile, OtherFormat, TableMismatch
from hexapods.domain.grid import FootGrid
from hexapods.runs.npz_slices import NpzSlices
from hexapods.runs.tables import FORMAT, table_arrays


class TableFile:
    """Q-table in an `.npz` file written by `hexapods.runs.tables`.

    Attributes:
        meta: metadata as in `Checkpoint.meta`.
        table: its rows, of states or of landings.
    """

    def __init__(self, file: IO[bytes], label: str) -> None:
        """Read the metadata and the offsets of the arrays.

        Args:
            file: the file, whose checksum was verified.
            label: name of the file for error messages.

        Raises:
            TableMismatch: if the agent has no Q-table, or the lengths of the arrays differ.
            OtherFormat: if it is of another version.
            DamagedFile: if it is no valid table file.
            InvalidInput: if the table is too large.
        """
        try:
            self._slices = NpzSlices(file)
            self.meta: Mapping[str, Any] = json.loads(str(self._slices.rows("meta")))
            check_format(label, self.meta["format"], FORMAT)
            names = table_arrays({name.removeprefix("agent.") for name in self._slices.arrays})
            if names is None:
                raise TableMismatch(f"the agent {self.meta['agent']} keeps no Q-table")
            self._columns = [f"agent.{name}" for name in names]
            columns = [self._slices.arrays[name] for name in self._columns]
            if any(len(column.shape) != 1 for column in columns):
                raise ValueError("its arrays are of another shape")
            grid = FootGrid(self.meta["grid_side_m"], self.meta["divisions"])
            shape = len(self.meta["pairs"]), len(grid)
        except (TableMismatch, OtherFormat):
            raise
        except Exception as error:  # zipfile and NumPy document no complete list of exceptions
            raise DamagedFile(f"{label} is not a Q-table of this product: {error}") from error
        kinds = "".join(column.dtype.kind for column in columns)
        if kinds != "ifu" or len({column.shape for column in columns}) > 1:
            raise TableMismatch("the table's values, visits and places do not fit together")
        self.table: TableRows | LandingRows
        if names == LANDING_ARRAYS:
            check_landings(*shape)
            self.table = LandingRows(*shape, self._chunks)
        else:
            check_size(*shape)
            self.table = TableRows(*shape, self._chunks)

    def _chunks(self) -> Iterator[Chunk]:
        for first in range(0, self._slices.length(self._columns[0]), VALUES_AT_ONCE):
            end = first + VALUES_AT_ONCE
            where, q, n = (self._slices.rows(name, first, end) for name in self._columns)
            yield where, q, n
