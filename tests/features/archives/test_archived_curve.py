"""The learning curve in an archive: long ones are decoded in pieces, and malformed ones refused."""

import json
from typing import Any

import msgspec
import pytest

from app.features.archives.archived_curve import read_curve

LONG = [{"step": n, "distance_m": n / 7, "epsilon": 1 / (n + 1)} for n in range(60_000)]
ROW = {"step": 1, "distance_m": 0.5, "epsilon": 0.1}


@pytest.mark.parametrize("indent", [None, 1])
@pytest.mark.parametrize("rows", [[], [ROW], LONG], ids=len)
def test_a_curve_is_read_as_it_was_written(rows: list[dict[str, Any]], indent: int | None) -> None:
    curve = read_curve(json.dumps(rows, indent=indent).encode())
    assert len(curve) == len(rows)
    assert list(curve) == rows
    assert curve[-2:] == rows[-2:]
    assert curve.is_ordered


@pytest.mark.parametrize("rows", [[ROW, ROW], [*LONG, ROW]], ids=len)
def test_a_curve_out_of_order_is_refused(rows: list[dict[str, Any]]) -> None:
    assert not read_curve(json.dumps(rows).encode()).is_ordered


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('"step": 50000,', '"step": -1,'),
        ('"step": 50000,', '"step": {},'),
        ('"step": 50000,', '"step": 50000, "}": 1,'),
        ('"step": 50000,', '"step": 50000, "step": 50000,'),
        ('"step": 50000,', '"step": 50000 "a"'),
        ('{"step": 50000,', '[{"step": 50000,'),
        ('{"step": 50000,', '1, {"step": 50000,'),
        ('{"step": 50000,', " " * 2_000_000 + '{"step": 50000,'),
    ],
    ids=lambda text: text.strip()[:40],
)
def test_a_malformed_row_far_inside_is_refused(old: str, new: str) -> None:
    text = json.dumps(LONG)
    assert old in text
    with pytest.raises((ValueError, msgspec.DecodeError)):
        read_curve(text.replace(old, new).encode())
