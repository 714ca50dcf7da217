"""The learning curve in a run's archive: decoded in pieces, and kept in a few bytes a row.

As a list of dictionaries, the curve of an archive of 64 MB would take over a gigabyte.
"""

import re
from array import array
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any, overload

import msgspec

from app.storage.untrusted_input import Metres, Share, Step, UntrustedInput

_PIECE_BYTES = 1_000_000
_MAX_ROW_BYTES = 300
_AFTER_ROW = re.compile(rb"\s*,")


class _Evaluation(UntrustedInput, frozen=True, gc=False):
    step: Step
    distance_m: Metres
    epsilon: Share


_FIELDS = _Evaluation.__struct_fields__


class CurveRows(Sequence[Mapping[str, Any]]):
    """Rows of a curve, as of `Curves.append`; each is made when it is read."""

    def __init__(self) -> None:
        """Begin with none."""
        self._columns: tuple[array[Any], ...] = (array("q"), array("d"), array("d"))

    def extend(self, rows: Sequence[_Evaluation]) -> None:
        """Append rows."""
        for name, column in zip(_FIELDS, self._columns, strict=True):
            column.extend(getattr(row, name) for row in rows)

    @property
    def is_ordered(self) -> bool:
        """Whether each row is of a later step than the one before."""
        return all(step < later for step, later in pairwise(self._columns[0]))

    def __len__(self) -> int:
        return len(self._columns[0])

    @overload
    def __getitem__(self, index: int) -> Mapping[str, Any]: ...

    @overload
    def __getitem__(self, index: slice) -> Sequence[Mapping[str, Any]]: ...

    def __getitem__(self, index: int | slice) -> Mapping[str, Any] | Sequence[Mapping[str, Any]]:
        if isinstance(index, int):
            return {
                name: column[index] for name, column in zip(_FIELDS, self._columns, strict=True)
            }
        return [self[number] for number in range(*index.indices(len(self)))]


def read_curve(data: bytes) -> CurveRows:
    """Decode the JSON array of a curve.

    Raises:
        ValueError: if it is none: a field is unknown, missing, there twice or out of range.
    """
    rows = CurveRows()
    for piece in _pieces(data):
        decoded = msgspec.json.decode(piece, type=list[_Evaluation])
        # Values are numbers, so that all quotation marks are those of keys.
        if piece.count(b'"') != 2 * len(_FIELDS) * len(decoded):
            raise ValueError("an evaluation has a field twice")
        if len(piece) > _MAX_ROW_BYTES * (len(decoded) + 1):
            raise ValueError("its curve has more blanks than indentation needs")
        rows.extend(decoded)
    return rows


def _pieces(data: bytes) -> Iterator[bytes]:
    """Split an array of objects without objects in them into smaller arrays."""
    if len(data) <= _PIECE_BYTES:
        yield data
        return
    # If the curve has another form, a piece is not JSON, and is refused.
    start, end = data.index(b"[") + 1, len(data) - 1
    while end - start > _PIECE_BYTES:
        after = data.rindex(b"}", start, start + _PIECE_BYTES) + 1
        yield b"[" + data[start:after] + b"]"
        separator = _AFTER_ROW.match(data, after)
        if separator is None:
            break
        start = separator.end()
    yield b"[" + data[start:end] + b"]"
