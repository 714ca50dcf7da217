"""Properties, blocks and macros of xacro as a place in a document sees them."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from hexapods.imports.documents.expressions import (
    Budget,
    Evaluator,
    InvalidExpression,
    Namespace,
    Value,
    as_text,
    check_size,
)
from hexapods.imports.documents.xml import Element
from hexapods.imports.notes import quoted

_PIECE = re.compile(r"(\$\$+[{(])|\$\{([^}]*)\}|\$\(([^)]*)\)|([^$]+|\$(?![{(]))")
"""Escaped, an expression, a command, plain text."""
_MAX_RESOLVING = 60
"""Properties that are defined by each other."""
_PARAMETER = re.compile(
    r"\s*([^\s:=]+)(?:\s*:?=\s*(\^\|?)?"
    r"((?:\$\{[^}]*\}|\$\([^)]*\)|'[^']*'|\"[^\"]*\"|[^\s'\"])*))?(?:\s+|$)"
)


@dataclass(frozen=True)
class Macro:
    """A macro.

    Attributes:
        body: the element that defines it.
        parameters: their names, those of blocks with one or two asterisks.
        defaults: whether the caller's property of the name counts first, and the text by default.
    """

    body: Element
    parameters: Sequence[str]
    defaults: Mapping[str, tuple[bool, str | None]]


def macro(element: Element) -> Macro:
    """Return the macro that an element defines.

    Raises:
        InvalidExpression: if its parameters are not as xacro has them.
    """
    text, at = element.attributes.get("params", "").strip(), 0
    parameters = list[str]()
    defaults: dict[str, tuple[bool, str | None]] = {}
    while at < len(text):
        parameter = _PARAMETER.match(text, at)
        if parameter is None or parameter.end() == at:
            raise InvalidExpression(f"its params are not as xacro has them: {quoted(text[at:])!r}")
        at = parameter.end()
        name, forwards, default = parameter.groups()
        parameters.append(name)
        if default is not None:
            defaults[name] = (forwards is not None, None if forwards == "^" else default)
    return Macro(element, parameters, defaults)


@dataclass(eq=False)
class Scope:
    """What is defined at a place, in the macro or namespace around it, and so on.

    Attributes:
        parent: the scope around it.
        is_namespace: whether it is that of an included file with a name.
        values: properties that are evaluated.
        texts: properties that are evaluated when they are first needed.
        blocks: elements by name, with one asterisk as they are, with two their children.
        macros: macros by name.
        spaces: namespaces by name.
    """

    parent: "Scope | None" = None
    is_namespace: bool = False
    values: dict[str, Value] = field(default_factory=dict)
    texts: dict[str, str] = field(default_factory=dict)
    blocks: dict[str, list[Element]] = field(default_factory=dict)
    macros: dict[str, Macro] = field(default_factory=dict)
    spaces: dict[str, "Scope"] = field(default_factory=dict)

    def chain(self) -> Iterator["Scope"]:
        """Iterate over this scope and those around it."""
        scope: Scope | None = self
        while scope is not None:
            yield scope
            scope = scope.parent

    def set_text(self, name: str, text: str) -> None:
        """Set a property to a text that is evaluated when it is first needed."""
        self.forget(name)
        value = literal(text)
        if isinstance(value, str):
            self.texts[name] = value
        else:
            self.values[name] = value

    def set_value(self, name: str, value: Value) -> None:
        """Set a property to a value."""
        self.forget(name)
        self.values[name] = literal(value)

    def forget(self, name: str) -> None:
        """Remove a property of this scope."""
        self.values.pop(name, None)
        self.texts.pop(name, None)

    def has(self, name: str) -> bool:
        """Whether a property can be seen."""
        return any(name in scope.values or name in scope.texts for scope in self.chain())

    def block(self, name: str) -> list[Element] | None:
        """Return the elements of a block."""
        for scope in self.chain():
            for key in (f"**{name}", f"*{name}"):
                if key in scope.blocks:
                    return scope.blocks[key]
        return None

    def find_macro(self, name: str) -> tuple[Macro, "Scope"] | None:
        """Return a macro, and the scope around its body: the caller's, or that of its namespace."""
        for scope in self.chain():
            if name in scope.macros:
                return scope.macros[name], self
        *names, last = name.split(".")
        inner: Scope | None = self
        for space in names:
            spaces = [scope.spaces for scope in inner.chain()] if inner else []
            inner = next((found[space] for found in spaces if space in found), None)
        if inner is None or inner is self or last not in inner.macros:
            return None
        return inner.macros[last], inner


class Texts:
    """Evaluates `${…}` and `$(…)` in texts.

    Args:
        command: returns the value of a `$(…)`.
        namespace: names of `xacro.…`.
        budget: of operations.
    """

    def __init__(
        self, command: Callable[[str], Value], namespace: Mapping[str, Value], budget: Budget
    ) -> None:
        self._command = command
        self._namespace = Namespace(namespace.__getitem__)
        self._direct = namespace
        self._evaluator, self._budget = Evaluator(budget), budget
        self._resolving: list[tuple[Scope, str]] = []

    def text(self, text: str, scope: Scope) -> str:
        """Return a text with what is in it replaced.

        Raises:
            InvalidExpression: saying what cannot be evaluated.
        """
        return text if "$" not in text else as_text(self.value(text, scope))

    def value(self, text: str, scope: Scope) -> Value:
        """Return the value of a text: of a lone `${…}` with its type.

        Raises:
            InvalidExpression: saying what cannot be evaluated.
        """
        self._budget.spend(1 + len(text) // 100)
        values, at = list[Value](), 0
        while at < len(text):
            piece = _PIECE.match(text, at)
            if piece is None:
                raise InvalidExpression(f"{quoted(text[at:])!r} is not closed")
            at = piece.end()
            values.append(self._piece(piece, scope))
        if len(values) == 1:
            return values[0]
        return check_size("".join(map(as_text, values)))

    def _piece(self, piece: re.Match[str], scope: Scope) -> Value:
        escaped, expression, command, plain = piece.groups()
        if expression is not None:
            return self.expression(self.text(expression, scope), scope)
        if command is not None:
            return self._command(self.text(command, scope))
        return plain if escaped is None else escaped[1:]

    def expression(self, text: str, scope: Scope) -> Value:
        """Return the value of an expression.

        Raises:
            InvalidExpression: saying why it has none.
        """
        return self._evaluator.value(text, lambda name: self._named(name, scope))

    def _named(self, name: str, scope: Scope) -> Value:
        for outer in scope.chain():
            if name in outer.values:
                return outer.values[name]
            if name in outer.texts:
                return self._resolved(name, outer)
            if name in outer.spaces:
                return Namespace(partial(self._named, scope=outer.spaces[name]))
        if name == "xacro":
            return self._namespace
        return self._direct[name]

    def _resolved(self, name: str, scope: Scope) -> Value:
        """Evaluate a property, which then keeps its value."""
        if (scope, name) in self._resolving:
            raise InvalidExpression(f"{quoted(name)!r} is defined by itself")
        if len(self._resolving) > _MAX_RESOLVING:
            raise InvalidExpression(f"{quoted(name)!r} is defined by too many others")
        self._resolving.append((scope, name))
        try:
            value = self.value(scope.texts[name], scope)
        finally:
            self._resolving.pop()
        scope.set_value(name, value)
        return scope.values[name]


def literal(value: Value) -> Value:
    """Return a text that is a number or a truth value as such, without quotes if it has them."""
    if not isinstance(value, str):
        return value
    if len(value) >= 2 and value[0] == value[-1] == "'":
        return value[1:-1]
    if "_" in value or len(value) > 60:
        return value
    kinds: tuple[Callable[[str], Any], ...] = (int, float)
    for kind in kinds:
        try:
            return kind(value)
        except ValueError:
            continue
    return {"true": True, "True": True, "false": False, "False": False}.get(value, value)


def truth(value: Value, text: str) -> bool:
    """Return whether a condition holds.

    Raises:
        InvalidExpression: if it is neither true nor false.
    """
    plain = literal(value)
    if isinstance(plain, str):
        raise InvalidExpression(
            f"a condition must be true or false, not {quoted(plain)!r} ({quoted(text)})"
        )
    return bool(plain)
