"""Evaluate the expressions of xacro, which are Python's, within bounds and without Python's means.

Only operators, literals, subscripts and the functions listed here exist. A dot reads a key of a
mapping or a name of a namespace, never an attribute of an object.
"""

import ast
import math
import operator
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache, partial, reduce
from typing import Any

from hexapods.imports.notes import quoted

MAX_EXPRESSION = 2000
"""Characters of an expression."""
MAX_TEXT = 20_000
"""Characters of a text."""
MAX_ITEMS = 10_000
"""Values in a list or mapping, with all that is in them; ten characters count as a value."""
MAX_STEPS = 500_000
"""Operations for all documents of an upload together."""
_MAX_WHOLE = 10**18
_MAX_BITS = 128
_MAX_DIGITS = 30
_FORMAT = re.compile(r"%(?:[-+ #0]*\d{0,2}(?:\.\d{1,2})?[diouxXeEfFgGsr]|%)")

Value = Any
"""A number, text, truth value, None, list, tuple, mapping, `Function` or `Names`."""
Names = Callable[[str], Value]
"""Looks a name up; raises KeyError if it is not defined."""


class InvalidExpression(ValueError):
    """An expression that cannot be evaluated; the message says why."""

    is_placed = False
    """Whether the message names the expression."""

    def within(self, text: str) -> "InvalidExpression":
        """Return the error with the expression in which it is, the innermost one."""
        if self.is_placed:
            return self
        error = InvalidExpression(f"{self}, in {quoted(text.strip())!r}")
        error.is_placed = True
        return error


@dataclass(frozen=True)
class Function:
    """A function that expressions may call.

    Attributes:
        call: returns its value.
        takes_names: whether it takes arguments by name.
    """

    call: Callable[..., Value]
    takes_names: bool = False


@dataclass(frozen=True)
class Namespace:
    """Names behind a dot, such as `math.pi`."""

    names: Names


def as_text(value: Value) -> str:
    """Return a value as it stands in a document.

    Raises:
        InvalidExpression: if it is a function, or too long.
    """
    if isinstance(value, str):
        return value
    if isinstance(value, (Function, Namespace)):
        raise InvalidExpression("a function is no value")
    check_size(value)
    text = str(value)
    if len(text) > MAX_TEXT:
        raise InvalidExpression(f"a text of more than {MAX_TEXT:,} characters")
    return text


def check_size(value: Value) -> Value:
    """Return a value, unless it is too large.

    Raises:
        InvalidExpression: if it is.
    """
    if isinstance(value, str):
        if len(value) > MAX_TEXT:
            raise InvalidExpression(f"a text of more than {MAX_TEXT:,} characters")
    elif isinstance(value, int):
        if abs(value) > _MAX_WHOLE:
            raise InvalidExpression("a whole number of more than 18 digits")
    elif isinstance(value, complex):
        raise InvalidExpression("a complex number")
    elif isinstance(value, (list, tuple, dict)):
        waiting, count = [value], 0
        while waiting:
            items = waiting.pop()
            values = items.values() if isinstance(items, dict) else items
            count += len(items)
            count += sum(len(item) // 10 for item in values if isinstance(item, str))
            if count > MAX_ITEMS:
                raise InvalidExpression(f"a list of more than {MAX_ITEMS:,} values")
            waiting += [item for item in values if isinstance(item, (list, tuple, dict))]
    return value


class Budget:
    """Operations that the documents of an upload may take, all together."""

    def __init__(self) -> None:
        self._steps = MAX_STEPS

    def spend(self, steps: int = 1) -> None:
        """Count operations.

        Raises:
            InvalidExpression: if they are too many.
        """
        self._steps -= steps
        if self._steps < 0:
            raise InvalidExpression(f"to expand it takes more than {MAX_STEPS:,} operations")


class Evaluator:
    """Evaluates expressions within a budget."""

    def __init__(self, budget: Budget) -> None:
        self._spend = budget.spend

    def value(self, text: str, names: Names) -> Value:
        """Return the value of an expression.

        Args:
            text: the expression.
            names: looks names up first; then the functions of this module count.

        Raises:
            InvalidExpression: saying why it has none.
        """
        try:
            return self._value(_parsed(text.strip()), names)
        except InvalidExpression as error:
            raise error.within(text) from error
        except (ArithmeticError, TypeError, ValueError, LookupError) as error:
            raise InvalidExpression(str(error)).within(text) from error
        except (RecursionError, MemoryError) as error:
            raise InvalidExpression("it is nested too deeply").within(text) from error

    def _value(self, node: ast.AST, names: Names) -> Value:
        self._spend()
        method = _NODES.get(type(node))
        if method is None:
            kind = type(node).__name__
            raise InvalidExpression(f"{_UNSUPPORTED.get(kind, kind)} is not supported")
        return getattr(self, method)(node, names)

    def _constant(self, node: ast.Constant, _: Names) -> Value:
        if not isinstance(node.value, (bool, int, float, str, type(None))):
            raise InvalidExpression(f"a value of type {type(node.value).__name__}")
        return check_size(node.value)

    def _name(self, node: ast.Name, names: Names) -> Value:
        try:
            return names(node.id)
        except KeyError:
            pass
        if node.id in GLOBALS:
            return GLOBALS[node.id]
        raise InvalidExpression(f"{quoted(node.id)!r} is not defined")

    def _attribute(self, node: ast.Attribute, names: Names) -> Value:
        owner = self._value(node.value, names)
        if not node.attr.startswith("_"):
            if isinstance(owner, dict) and node.attr in owner:
                return owner[node.attr]
            if isinstance(owner, Namespace):
                try:
                    return owner.names(node.attr)
                except KeyError:
                    pass
            for kind, methods in _METHODS.items():
                if isinstance(owner, kind) and node.attr in methods:
                    return Function(partial(methods[node.attr], owner))
        raise InvalidExpression(f"there is no {quoted(node.attr)!r} behind the dot")

    def _call(self, node: ast.Call, names: Names) -> Value:
        function = self._value(node.func, names)
        if not isinstance(function, Function):
            raise InvalidExpression("only functions can be called")
        if node.keywords and not function.takes_names:
            raise InvalidExpression("arguments by name are not supported")
        values = [self._value(argument, names) for argument in node.args]
        named = {
            keyword.arg: self._value(keyword.value, names)
            for keyword in node.keywords
            if keyword.arg is not None
        }
        for value in values:
            if isinstance(value, (list, tuple, dict, str)):
                self._spend(len(value) // 10)
        return check_size(function.call(*values, **named))

    def _subscript(self, node: ast.Subscript, names: Names) -> Value:
        owner = self._value(node.value, names)
        if not isinstance(owner, (str, list, tuple, dict)):
            raise InvalidExpression("only texts, lists and mappings have items")
        if isinstance(node.slice, ast.Slice):
            ends = (node.slice.lower, node.slice.upper, node.slice.step)
            numbers = [None if end is None else self._value(end, names) for end in ends]
            if isinstance(owner, dict):
                raise InvalidExpression("a mapping has no slices")
            return owner[slice(*numbers)]
        key = self._value(node.slice, names)
        if isinstance(owner, dict) and key not in owner:
            raise InvalidExpression(f"there is no {quoted(str(key))!r}")
        return owner[key]

    def _binary(self, node: ast.BinOp, names: Names) -> Value:
        left, right = self._value(node.left, names), self._value(node.right, names)
        operate = _BINARY.get(type(node.op))
        if operate is None:
            raise InvalidExpression(f"the operator {type(node.op).__name__} is not supported")
        for value in (left, right):
            if not isinstance(value, (bool, int, float, str, list, tuple)):
                raise InvalidExpression(f"a value of type {type(value).__name__} in a calculation")
        return check_size(operate(left, right))

    def _unary(self, node: ast.UnaryOp, names: Names) -> Value:
        value = self._value(node.operand, names)
        if isinstance(node.op, ast.Not):
            return not value
        if not isinstance(value, (bool, int, float)):
            raise InvalidExpression("a sign before what is no number")
        return check_size(_UNARY[type(node.op)](value))

    def _boolean(self, node: ast.BoolOp, names: Names) -> Value:
        ends_with = isinstance(node.op, ast.Or)
        value: Value = None
        for operand in node.values:
            value = self._value(operand, names)
            if bool(value) is ends_with:
                break
        return value

    def _comparison(self, node: ast.Compare, names: Names) -> Value:
        left = self._value(node.left, names)
        for comparison, operand in zip(node.ops, node.comparators, strict=True):
            right = self._value(operand, names)
            self._spend(
                sum(len(v) // 10 for v in (left, right) if isinstance(v, (str, list, dict)))
            )
            if not _COMPARISONS[type(comparison)](left, right):
                return False
            left = right
        return True

    def _condition(self, node: ast.IfExp, names: Names) -> Value:
        return self._value(node.body if self._value(node.test, names) else node.orelse, names)

    def _list(self, node: ast.List | ast.Tuple, names: Names) -> Value:
        values = [self._value(item, names) for item in node.elts]
        return check_size(values if isinstance(node, ast.List) else tuple(values))

    def _comprehension(self, node: ast.ListComp | ast.GeneratorExp, names: Names) -> Value:
        loop, *others = node.generators
        if others:
            raise InvalidExpression("a comprehension of several loops is not supported")
        values = []
        for item in _items(self._value(loop.iter, names)):
            inner = _with_targets(loop.target, item, names)
            if all(self._value(condition, inner) for condition in loop.ifs):
                values.append(self._value(node.elt, inner))
        return check_size(values)

    def _mapping(self, node: ast.Dict, names: Names) -> Value:
        if any(key is None for key in node.keys):
            raise InvalidExpression("`**` is not supported")
        pairs = [
            (self._value(key, names), self._value(value, names))
            for key, value in zip(node.keys, node.values, strict=True)
            if key is not None
        ]
        if not all(isinstance(key, (str, int, float)) for key, _ in pairs):
            raise InvalidExpression("a key must be a text or a number")
        return check_size(dict(pairs))


def _items(values: Value) -> list[Value]:
    if not isinstance(values, (list, tuple, dict, str)):
        raise InvalidExpression(f"a value of type {type(values).__name__} has no items")
    return [*values]


def _with_targets(target: ast.expr, item: Value, names: Names) -> Names:
    """Return names with those that a loop sets."""
    targets, items = [target], [item]
    if isinstance(target, ast.Tuple):
        targets, items = target.elts, _items(item)
    if not all(isinstance(name, ast.Name) for name in targets) or len(targets) != len(items):
        raise InvalidExpression("the loop of a comprehension must set names")
    pairs = zip(targets, items, strict=True)
    values = {name.id: value for name, value in pairs if isinstance(name, ast.Name)}
    return lambda name: values[name] if name in values else names(name)


@lru_cache(maxsize=4096)
def _parsed(text: str) -> ast.expr:
    if len(text) > MAX_EXPRESSION:
        raise InvalidExpression(f"an expression of more than {MAX_EXPRESSION:,} characters")
    try:
        return ast.parse(text, mode="eval").body
    except (SyntaxError, ValueError) as error:
        raise InvalidExpression("it is no expression") from error


def _total(values: Value, start: Value = 0) -> Value:
    """Return the sum, from left to right on every Python."""
    return reduce(operator.add, _items(values), start)


def _power(base: Value, exponent: Value) -> Value:
    are_whole = isinstance(base, int) and isinstance(exponent, int)
    if are_whole and exponent > 0 and base.bit_length() * exponent > _MAX_BITS:
        raise InvalidExpression("a whole number of more than 18 digits")
    return base**exponent


def _product(left: Value, right: Value) -> Value:
    for items, count in ((left, right), (right, left)):
        are_repeated = isinstance(items, (str, list, tuple)) and isinstance(count, int)
        if are_repeated and len(items) * count > MAX_ITEMS:
            raise InvalidExpression(f"more than {MAX_ITEMS:,} characters or values")
    return left * right


def _remainder(left: Value, right: Value) -> Value:
    if isinstance(left, str):
        values = right if isinstance(right, tuple) else (right,)
        if "%" in _FORMAT.sub("", left):
            raise InvalidExpression("such a format is not supported")
        if not all(isinstance(value, (int, float, str)) for value in values):
            raise InvalidExpression("only numbers and texts can be formatted")
    return left % right


def _rounded(number: Value, digits: Value = None) -> Value:
    if digits is not None and abs(digits) > _MAX_DIGITS:
        raise InvalidExpression(f"more than {_MAX_DIGITS} digits")
    return round(number, digits)


def _range(*numbers: Value) -> Value:
    steps = range(*numbers)
    if len(steps) > MAX_ITEMS:
        raise InvalidExpression(f"a list of more than {MAX_ITEMS:,} values")
    return list(steps)


def _whole(value: Value = 0) -> Value:
    if isinstance(value, str) and len(value) > _MAX_DIGITS:
        raise InvalidExpression("a whole number of more than 18 digits")
    return int(value)


def _tokens(text: Value, separators: Value = ",; ", skips_empty: Value = True) -> Value:
    words = re.split(f"[{re.escape(str(separators))}]", str(text))
    return [word for word in words if word or not skips_empty]


def _mapped(function: Value, values: Value) -> Value:
    if not isinstance(function, Function):
        raise InvalidExpression("only functions can be called")
    return [function.call(value) for value in values]


def _list_of(values: Iterable[Value] = ()) -> Value:
    return list(values)


def _mapping_of(*pairs: Value, **named: Value) -> Value:
    return dict(*pairs, **named)


_MATH = (
    *("sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "sqrt", "pow"),
    *("exp", "log", "log2", "log10", "floor", "ceil", "trunc", "fabs", "fmod", "hypot", "copysign"),
    *("radians", "degrees", "isnan", "isinf", "isclose"),
)
_MATH_NAMES: dict[str, Value] = {
    **{name: Function(getattr(math, name)) for name in _MATH},
    **{name: getattr(math, name) for name in ("pi", "e", "tau", "inf", "nan")},
}
_PYTHON: dict[str, Value] = {
    "True": True,
    "False": False,
    "None": None,
    "list": Function(_list_of),
    "tuple": Function(tuple),
    "dict": Function(_mapping_of, takes_names=True),
    "len": Function(len),
    "str": Function(as_text),
    "float": Function(float),
    "int": Function(_whole),
    "bool": Function(bool),
    "min": Function(min),
    "max": Function(max),
    "abs": Function(abs),
    "sum": Function(_total),
    "round": Function(_rounded),
    "range": Function(_range),
    "sorted": Function(sorted),
    "reversed": Function(lambda values: [*reversed(values)]),
    "map": Function(_mapped),
    "zip": Function(lambda *lists: [*zip(*lists, strict=False)]),
    "enumerate": Function(lambda values: [*enumerate(values)]),
    "any": Function(any),
    "all": Function(all),
}
GLOBALS: dict[str, Value] = {
    **_MATH_NAMES,
    **_PYTHON,
    "tokenize": Function(_tokens),
    "math": Namespace(_MATH_NAMES.__getitem__),
    "python": Namespace(_PYTHON.__getitem__),
}
"""What expressions may name beside what a document defines."""
_METHODS: Mapping[type, Mapping[str, Callable[..., Value]]] = {
    str: {
        "lower": str.lower,
        "upper": str.upper,
        "strip": str.strip,
        "startswith": str.startswith,
        "endswith": str.endswith,
        "split": str.split,
    },
    dict: {
        "get": dict.get,
        "keys": lambda mapping: [*mapping],
        "values": lambda mapping: [*mapping.values()],
        "items": lambda mapping: [*mapping.items()],
    },
}
_BINARY: dict[type, Callable[[Value, Value], Value]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: _product,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: _remainder,
    ast.Pow: _power,
}
_UNARY: dict[type, Callable[[Value], Value]] = {ast.USub: operator.neg, ast.UAdd: operator.pos}
_COMPARISONS: dict[type, Callable[[Value, Value], bool]] = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Is: operator.is_,
    ast.IsNot: operator.is_not,
    ast.In: lambda left, right: left in right,
    ast.NotIn: lambda left, right: left not in right,
}
_NODES = {
    ast.Constant: "_constant",
    ast.Name: "_name",
    ast.Attribute: "_attribute",
    ast.Call: "_call",
    ast.Subscript: "_subscript",
    ast.BinOp: "_binary",
    ast.UnaryOp: "_unary",
    ast.BoolOp: "_boolean",
    ast.Compare: "_comparison",
    ast.IfExp: "_condition",
    ast.List: "_list",
    ast.Tuple: "_list",
    ast.Dict: "_mapping",
    ast.ListComp: "_comprehension",
    ast.GeneratorExp: "_comprehension",
}
_UNSUPPORTED = {
    "Lambda": "a function of its own",
    "DictComp": "a comprehension",
    "SetComp": "a comprehension",
    "JoinedStr": "an f-string",
    "Starred": "`*`",
    "NamedExpr": "`:=`",
}
