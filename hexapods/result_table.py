"""Results as tables: columns of plain values, for data frames of any library and as CSV."""

import csv
import html
import io
import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from hexapods.domain.settings import Value
from hexapods.domain.text import text_cell
from hexapods.files import path_of, write_atomically

_SHOWN_ROWS, _SHOWN_COLUMNS = 20, 6
_SPACES = str.maketrans(dict.fromkeys("\u00a0\u2007\u2009\u202f", " "))


class ResultTable(dict[str, list[Value]]):
    """Columns of equal length by name; `pandas.DataFrame(table)` and `polars.DataFrame(table)` are.

    Values are numbers, text, True, False and None, of one type in a column besides None.
    """

    @classmethod
    def of(cls, rows: Iterable[Mapping[str, Any]]) -> "ResultTable":
        """Return the table of some rows, values by column; what a row does not have is None."""
        listed = list(rows)
        names = dict.fromkeys(name for row in listed for name in row)
        return cls({name: _column([row.get(name) for row in listed]) for name in names})

    @property
    def rows(self) -> list[dict[str, Value]]:
        """The rows: values by column."""
        return [dict(zip(self, values, strict=True)) for values in zip(*self.values(), strict=True)]

    def save_csv(self, path: str | os.PathLike[str]) -> Path:
        """Write the table as CSV; text that a spreadsheet would evaluate is quoted by `'`.

        Returns:
            the path.

        Raises:
            InvalidInput: if it is no path.
            OSError: if the file cannot be written.
        """
        target, out = path_of(path, "a file"), io.StringIO()
        writer = csv.writer(out)
        writer.writerow(self)
        for row in self.rows:
            writer.writerow(
                text_cell(value) if isinstance(value, str) else value for value in row.values()
            )
        write_atomically(target, out.getvalue().encode())
        return target

    def __repr__(self) -> str:
        names = ", ".join(list(self)[:_SHOWN_COLUMNS])
        more = ", …" if len(self) > _SHOWN_COLUMNS else ""
        return f"<ResultTable: {len(self.rows):,} rows of {len(self)} columns: {names}{more}>"

    def _repr_html_(self) -> str:
        body = [self, *(row.values() for row in self.rows[:_SHOWN_ROWS])]
        text = "".join(f"<tr>{''.join(map(_cell, row))}</tr>" for row in body)
        rest = len(self.rows) - _SHOWN_ROWS
        more = f"<p>and {rest:,} more rows</p>" if rest > 0 else ""
        return f"<table>{text}</table>{more}"


def _column(values: Sequence[Any]) -> list[Value]:
    """Return values of one type: whole numbers beside others as those, other mixtures as text."""
    kinds = {type(value) for value in values if value is not None}
    if kinds == {int, float}:
        return [None if value is None else float(value) for value in values]
    if kinds == {str} or len(kinds) > 1:
        return [None if value is None else str(value).translate(_SPACES) for value in values]
    return list(values)


def _cell(value: Value) -> str:
    text = f"{value:.6g}" if isinstance(value, float) else "" if value is None else str(value)
    return f"<td>{html.escape(text)}</td>"
