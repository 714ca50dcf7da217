"""Random-access reader of a Q-table file: reads row by row, in constant memory."""

import io
import struct
import zipfile
from collections.abc import Iterator, Mapping
from typing import Any, BinaryIO, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from hexapods.agents.q_table import check_size
from hexapods.agents.table_rows import VALUES_AT_ONCE, Part, TableRows
from hexapods.domain.errors import DamagedFile, TableMismatch
from hexapods.domain.grid import FootGrid
from hexapods.domain.types import Cells, FloatArray
from hexapods.runs.tables import FORMAT, read_meta

_LOCAL_HEADER = struct.Struct("<26xHH")
"""Lengths of the name and of the extra field in the local header of a zip member."""


class RandomAccessFile(Protocol):
    """File with thread-safe random access (as `pread`)."""

    def read_at(self, offset: int, length: int) -> bytes:
        """Return `length` bytes from an offset; fewer only at the end of the file."""


class TableFile:
    """Q-table in an `.npz` file written by `hexapods.runs.tables`.

    Attributes:
        meta: metadata as in `Checkpoint.meta`.
        groups, cells: number of groups of legs and of cells of the foot grid.
    """

    def __init__(self, file: RandomAccessFile, readable: BinaryIO, label: str) -> None:
        """Read the metadata and the offsets of the arrays.

        Args:
            file: the file, whose checksum was verified.
            readable: the same file from its start; used by the constructor only.
            label: name of the file for error messages.

        Raises:
            TableMismatch: if the agent has no Q-table, or the lengths of the arrays differ.
            DamagedFile: if it is no valid table file.
            InvalidInput: if the table is too large.
        """
        self._file = file
        try:
            with zipfile.ZipFile(readable) as archive:
                members = {member.filename: member for member in archive.infolist()}
                self.meta: Mapping[str, Any] = read_meta(_text(archive, "meta.npy"))
                if self.meta["format"] != FORMAT:
                    raise ValueError(f"it has format {self.meta['format']}, not {FORMAT}")
                if "agent.where.npy" not in members:
                    raise TableMismatch(f"the agent {self.meta['agent']} keeps no Q-table")
                self._where, self._q, self._n = (
                    _column(file, archive, members[f"agent.{name}.npy"])
                    for name in ("where", "q", "n")
                )
            grid = FootGrid(self.meta["grid_side_m"], self.meta["divisions"])
            self.groups, self.cells = len(self.meta["pairs"]), len(grid)
        except TableMismatch:
            raise
        except Exception as error:  # zipfile and NumPy document no complete list of exceptions
            raise DamagedFile(f"{label} is not a Q-table of this product: {error}") from error
        kinds = self._where.dtype.kind + self._q.dtype.kind + self._n.dtype.kind
        if kinds != "ifu" or not self._where.length == self._q.length == self._n.length:
            raise TableMismatch("the table's values, visits and places do not fit together")

        check_size(self.groups, self.cells)

    def rows(self) -> Iterator[tuple[Cells, FloatArray, FloatArray]]:
        """Yield all states in order, with values and visits, (groups, cells), NaN illegal."""
        return TableRows(self.groups, self.cells, self._parts).rows()

    def _parts(self) -> Iterator[Part]:
        for first in range(0, self._where.length, VALUES_AT_ONCE):
            where, q, n = (
                column.read(self._file, first) for column in (self._where, self._q, self._n)
            )
            yield where, q, n


class _Column(NamedTuple):
    """Location of a one-dimensional array in a file."""

    offset: int
    dtype: np.dtype[Any]
    length: int

    def read(self, file: RandomAccessFile, first: int) -> NDArray[Any]:
        """Read up to `VALUES_AT_ONCE` elements from index `first`."""
        count = min(VALUES_AT_ONCE, self.length - first)
        size = self.dtype.itemsize
        return np.frombuffer(file.read_at(self.offset + first * size, count * size), self.dtype)


def _column(file: RandomAccessFile, archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> _Column:
    if member.compress_type != zipfile.ZIP_STORED:
        raise ValueError("its members are compressed")
    name, extra = _LOCAL_HEADER.unpack(file.read_at(member.header_offset, _LOCAL_HEADER.size))
    data = member.header_offset + _LOCAL_HEADER.size + name + extra
    with archive.open(member) as opened:
        shape, _, dtype = _header(opened)
        count = int(np.prod(shape))
        header = member.file_size - count * dtype.itemsize
    if len(shape) != 1 or header <= 0:
        raise ValueError("its arrays are of another shape")
    return _Column(data + header, dtype, count)


def _header(opened: Any) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
    version = np.lib.format.read_magic(opened)
    read = {
        (1, 0): np.lib.format.read_array_header_1_0,
        (2, 0): np.lib.format.read_array_header_2_0,
    }[version]
    shape, is_fortran, dtype = read(opened)
    return shape, is_fortran, dtype


def _text(archive: zipfile.ZipFile, name: str) -> str:
    return str(np.load(io.BytesIO(archive.read(name)), allow_pickle=False))
