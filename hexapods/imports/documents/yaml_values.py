"""Read YAML that xacro loads: plain values within bounds, without anchors and tags of programs."""

import math
from collections.abc import Callable
from typing import Any

import yaml

from hexapods.imports.documents.expressions import InvalidExpression, check_size
from hexapods.imports.notes import quoted

MAX_YAML_BYTES = 256 << 10
_MAX_EVENTS = 20_000
_MAX_DEPTH = 40
_UNITS = {
    "!radians": 1.0,
    "!degrees": math.pi / 180,
    "!meters": 1.0,
    "!millimeters": 0.001,
    "!foot": 0.3048,
    "!inches": 0.0254,
}
"""Tags by which a number has a unit."""


def read_yaml(data: bytes, number: Callable[[str], float]) -> Any:
    """Return the values of a document: numbers, texts, truth values, lists and mappings.

    Args:
        data: the document, of at most `MAX_YAML_BYTES`.
        number: evaluates a number with a unit, which may be an expression.

    Raises:
        InvalidExpression: saying why it cannot be read.
    """

    class Loader(yaml.SafeLoader):  # type: ignore[misc] # PyYAML has no types
        """Reads plain values, and numbers with units."""

    def with_unit(loader: yaml.SafeLoader, tag: str, node: yaml.Node) -> float:
        if not isinstance(node, yaml.ScalarNode):
            raise InvalidExpression(f"{tag} stands before what is no number")
        return number(str(loader.construct_scalar(node))) * _UNITS[f"!{tag}"]

    Loader.add_multi_constructor("!", with_unit)
    try:
        text = data.decode("utf-8-sig")
        _check_events(text)
        return check_size(_plain(yaml.load(text, Loader)))  # noqa: S506 - a SafeLoader
    except (yaml.YAMLError, UnicodeError, ValueError, LookupError, TypeError) as error:
        if isinstance(error, InvalidExpression):
            raise
        why = " ".join(str(error).split())
        raise InvalidExpression(f"it is no YAML that can be read: {quoted(why)}") from error


def _check_events(text: str) -> None:
    depth = 0
    for count, event in enumerate(yaml.parse(text, yaml.SafeLoader)):
        if isinstance(event, yaml.AliasEvent):
            raise InvalidExpression("anchors of YAML are not read; write the values themselves")
        depth += isinstance(event, yaml.CollectionStartEvent)
        depth -= isinstance(event, yaml.CollectionEndEvent)
        if count > _MAX_EVENTS or depth > _MAX_DEPTH:
            raise InvalidExpression(
                f"it has more than {_MAX_EVENTS:,} values, or is nested over {_MAX_DEPTH} deep"
            )


def _plain(value: Any) -> Any:
    """Return a value without types that only YAML has, such as dates."""
    if isinstance(value, dict):
        return {key if isinstance(key, int) else str(key): _plain(v) for key, v in value.items()}
    if isinstance(value, (list, tuple, set)):
        return [_plain(item) for item in value]
    is_plain = value is None or isinstance(value, (bool, int, float, str))
    return check_size(value) if is_plain else str(value)
