"""YAML from outside, as plain values: limited in number and depth, without aliases and tags.

A few lines with aliases repeat a value a billion times (an alias bomb), and tags construct objects
of Python, so neither is read. Each name and value costs up to 40 µs of the processor, so that they
are counted.
"""

import re
from collections.abc import Callable
from typing import Any, NoReturn

import yaml

from hexapods.domain.errors import InvalidInput

MAX_NODES = 10_000
"""Most names and values that `read_plain` reads."""
_TAG = "tag:yaml.org,2002:"


class NodeLoader(yaml.SafeLoader):  # type: ignore[misc]  # PyYAML has no annotations
    """Composes nodes; refuses aliases, deep nesting and too many nodes.

    Attributes:
        max_depth: most levels of nesting.
        max_nodes: most names and values.
    """

    max_depth = 5
    max_nodes = 5_000
    _depth = _nodes = 0

    def compose_node(self, parent: Any, index: Any) -> Any:
        """Return the next node; raises a `YAMLError` for one that is refused."""
        event = self.peek_event()
        if isinstance(event, yaml.AliasEvent):
            problem = f"*{event.anchor[:40]}: aliases are not read; write the value out"
            raise yaml.composer.ComposerError(problem=problem, problem_mark=event.start_mark)
        self._nodes += 1
        if self._nodes > self.max_nodes:
            problem = f"it has more than {self.max_nodes:,} names and values"
            raise yaml.composer.ComposerError(problem=problem, problem_mark=event.start_mark)
        self._depth += 1
        if self._depth > self.max_depth:
            problem = f"it is nested too deeply: more than {self.max_depth} levels"
            raise yaml.composer.ComposerError(problem=problem, problem_mark=event.start_mark)
        node = super().compose_node(parent, index)
        self._depth -= 1
        return node


class _PlainLoader(NodeLoader):
    """Composes nodes whose plain scalars are those of JSON: YAML 1.1 takes `no` for false."""

    max_depth = 16
    max_nodes = MAX_NODES
    yaml_implicit_resolvers: dict[str, Any] = {}  # noqa: RUF012 - PyYAML's own, by first letter


class _PlainDumper(yaml.SafeDumper):  # type: ignore[misc]  # as above
    """Writes texts of several lines as blocks, and no aliases.

    Quotes texts that this module or a reader of YAML 1.1 would take for another type.
    """

    def ignore_aliases(self, data: Any) -> bool:
        """Whether to write a value out each time."""
        del data
        return True


for _name, _pattern, _first in (
    ("null", r"^(?:null|~|)$", ["n", "~", ""]),
    ("bool", r"^(?:true|false)$", ["t", "f"]),
    ("int", r"^[-+]?[0-9]{1,18}$", [*"-+0123456789"]),
    (
        "float",
        r"^[-+]?(?:[0-9]{1,18}\.[0-9]{0,18}|\.[0-9]{1,18}|[0-9]{1,18})(?:[eE][-+]?[0-9]{1,3})?$",
        [*"-+.0123456789"],
    ),
):
    for _kind in (_PlainLoader, _PlainDumper):
        _kind.add_implicit_resolver(f"{_TAG}{_name}", re.compile(_pattern), _first)


def root_node(content: bytes, name: str, what: str, loader: type[NodeLoader] = NodeLoader) -> Any:
    """Return the root of the graph of YAML nodes; no value is constructed.

    Args:
        content: the file.
        name: name of the file, for messages.
        what: kind of document, for messages, such as `servo map`.
        loader: class that composes the nodes.

    Raises:
        InvalidInput: naming the line, if it is not valid YAML, or has nodes that are refused.
    """
    try:
        return yaml.compose(content.decode("utf-8-sig"), Loader=loader)
    except UnicodeDecodeError as error:
        raise InvalidInput(f"{name} is no {what}: it is not text in UTF-8") from error
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        line = "" if mark is None else f", line {mark.line + 1}"
        details = [getattr(error, attribute, None) for attribute in ("context", "problem")]
        problem = ", ".join(filter(None, details)) or "it has characters that YAML does not allow"
        raise InvalidInput(f"{name}{line}: not valid YAML: {problem}") from error
    except RecursionError as error:
        raise InvalidInput(f"{name} is no {what}: it is nested too deeply") from error


def read_plain(content: bytes, name: str, what: str) -> Any:
    """Return a document as plain values: null, booleans, numbers, texts, lists and objects.

    Args:
        content: the file.
        name: name of the file, for messages.
        what: kind of document, for messages.

    Raises:
        InvalidInput: as `root_node`; also for a name that is given twice, and for other tags.
    """
    return _plain(root_node(content, name, what, _PlainLoader), name)


def nodes_of(value: Any) -> int:
    """Return the number of names and values in plain values, as `MAX_NODES` limits it."""
    if isinstance(value, dict):
        return 1 + len(value) + sum(map(nodes_of, value.values()))  # whole numbers
    return 1 + (sum(map(nodes_of, value)) if isinstance(value, list) else 0)  # whole numbers


def write_plain(value: Any) -> str:
    """Return plain values as YAML, which `read_plain` reads; long texts keep their lines."""
    return str(
        yaml.dump(value, Dumper=_PlainDumper, sort_keys=False, allow_unicode=True, width=100)
    )


def _text(dumper: _PlainDumper, text: str) -> Any:
    style = "|" if "\n" in text else None
    return dumper.represent_scalar(f"{_TAG}str", text, style=style)


_PlainDumper.add_representer(str, _text)


def _plain(node: Any, name: str) -> Any:
    if node is None:
        return None
    tag = node.tag.removeprefix(_TAG)
    if isinstance(node, yaml.ScalarNode) and tag in _SCALARS:
        try:
            return _SCALARS[tag](node.value)
        except ValueError:
            _refuse(node, name, f"{node.value[:40]!r} does not fit its tag")
    if isinstance(node, yaml.SequenceNode) and tag == "seq":
        return [_plain(item, name) for item in node.value]
    if not isinstance(node, yaml.MappingNode) or tag != "map":
        _refuse(node, name, f"the tag {tag[:40]!r} is not read")
    mapping: dict[str, Any] = {}
    for key, value in node.value:
        if not isinstance(key, yaml.ScalarNode):
            _refuse(key, name, "a name is a word, not a list or mapping")
        if key.value in mapping:
            _refuse(key, name, f"{key.value[:40]!r} is given twice")
        mapping[key.value] = _plain(value, name)
    return mapping


_SCALARS: dict[str, Callable[[str], Any]] = {
    "null": lambda value: None,  # noqa: ARG005
    "bool": lambda value: {"true": True, "false": False}.get(value, value),
    "int": int,
    "float": float,
    "str": str,
}


def _refuse(node: Any, name: str, problem: str) -> NoReturn:
    raise InvalidInput(f"{name}, line {node.start_mark.line + 1}: {problem}")
