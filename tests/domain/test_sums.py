"""Sums of floats have the same bits in every Python: the built-in `sum` is for whole numbers."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from hexapods.domain.sums import ordered_sum

ROOT = Path(__file__).parents[2]
MARK = "# whole numbers"
"""Comment at the end of a line whose `sum` is of whole numbers, where its items do not show it."""
_OTHER_NAMES = {"builtins.sum", "math.sumprod"}
_SIZES = {"nbytes", "file_size", "size", "triangles"}
"""Attributes that are numbers of bytes or triangles, and functions that return such."""


def _floating_sums(program: str) -> Iterator[int]:
    """Yield the lines of a program with a `sum` whose items may be floats."""
    tree, lines = ast.parse(program), program.splitlines()
    calls = {
        node.func: node.args[0]
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.args
    }
    for node in ast.walk(tree):
        is_sum = isinstance(node, ast.Name) and node.id == "sum"
        # Of another module, such as `builtins.sum` and `math.sumprod`; arrays have methods.
        is_sum |= isinstance(node, ast.Attribute) and ast.unparse(node) in _OTHER_NAMES
        if not is_sum or MARK in lines[node.lineno - 1]:  # type: ignore[attr-defined]
            continue
        items = calls.get(node)  # type: ignore[call-overload]
        if items is None or not _are_whole(items):
            yield node.lineno  # type: ignore[attr-defined]


def _are_whole(items: ast.expr) -> bool:
    """Whether the items of a sum are whole numbers by their form."""
    if isinstance(items, ast.GeneratorExp | ast.ListComp):
        return _is_whole(items.elt)
    if isinstance(items, ast.Call) and ast.unparse(items.func) == "map":
        return ast.unparse(items.args[0]) in ("len", "int")
    return False


def _is_whole(item: ast.expr) -> bool:
    if isinstance(item, ast.Constant):
        return isinstance(item.value, int)
    if isinstance(item, ast.Call):
        return ast.unparse(item.func) in ("len", "int", "_size_of")
    if isinstance(item, ast.Attribute):
        return item.attr in _SIZES
    if isinstance(item, ast.BinOp):
        is_exact = not isinstance(item.op, ast.Div | ast.Pow)
        return is_exact and _is_whole(item.left) and _is_whole(item.right)
    if isinstance(item, ast.BoolOp):
        return all(map(_is_whole, item.values))
    is_negation = isinstance(item, ast.UnaryOp) and isinstance(item.op, ast.Not)
    return is_negation or isinstance(item, ast.Compare)


@pytest.mark.test
@pytest.mark.parametrize(
    "package",
    [
        "hexapods",
        "app/features/classroom",
        "app/features/explanations",
        "app/features/what_if",
        "app/stage",
    ],
)
def test_no_float_is_summed_by_what_differs_between_pythons(package: str) -> None:
    programs = sorted((ROOT / package).rglob("*.py"))

    assert [
        f"{path.relative_to(ROOT)}:{line}"
        for path in programs
        for line in _floating_sums(path.read_text("utf-8"))
    ] == [], f"take hexapods.domain.sums.ordered_sum, or end the line with `{MARK}`"


@pytest.mark.parametrize(
    ("program", "is_refused"),
    [
        ("sum(values)", True),
        ("sum(x * y for x, y in pairs)", True),
        ("sum(len(x) / 2 for x in lists)", True),
        ("sum(map(float, texts))", True),
        ("totals = map(sum, rows)", True),
        ("import builtins; builtins.sum(values)", True),
        ("sum(1 for _ in items)", False),
        ("sum(map(len, items))", False),
        ("sum(len(x) * 2 for x in items)", False),
        ("sum(x is None for x in items)", False),
        ("sum(x < 1 and not x.failed for x in items)", False),
        (f"sum(sizes)  {MARK}", False),
        ("array.sum() + np.sum(array)", False),
    ],
)
def test_sums_are_refused_unless_their_items_are_whole(program: str, is_refused: bool) -> None:
    assert bool(list(_floating_sums(program))) == is_refused


def test_a_sum_rounds_after_each_addition() -> None:
    assert ordered_sum([0.1] * 10) == 0.9999999999999999  # 1.0 by `sum` since Python 3.12
    assert ordered_sum(iter([])) == 0.0
