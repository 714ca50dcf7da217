"""Expand xacro, the macro language in which ROS publishes robots, without ROS and within bounds.

Properties, macros with blocks and defaults, conditions, includes with namespaces, arguments,
`load_yaml` and `$(find …)` do what they do in the package `xacro` of ROS 2; expressions are those
of `expressions`. Files come from the upload only. What a document needs of files that are not there
is left out, as cameras and sensors are often in another package.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from hexapods.domain.errors import DamagedFile
from hexapods.imports.documents.expressions import (
    GLOBALS,
    Budget,
    Function,
    InvalidExpression,
    Value,
    as_text,
)
from hexapods.imports.documents.upload import Upload, last_part
from hexapods.imports.documents.xacro_scope import Scope, Texts, literal, macro, truth
from hexapods.imports.documents.xml import MAX_ELEMENTS, Element
from hexapods.imports.documents.yaml_values import MAX_YAML_BYTES, read_yaml
from hexapods.imports.notes import listed, quoted

MAX_CALLS = 5000
"""Macros that are called, and files that are included, in a document."""
MAX_DEPTH = 200
"""Elements, macros and files within each other."""
_PREFIX = "xacro:"
_BARE = frozenset({"property", "macro", "include", "if", "unless", "insert_block", "arg"})
"""Tags that old documents write without `xacro:`."""
_URDF = frozenset(
    [
        *("robot", "link", "joint", "visual", "collision", "inertial", "origin", "mass", "inertia"),
        *("geometry", "box", "cylinder", "sphere", "capsule", "mesh", "parent", "child", "axis"),
        *("limit", "dynamics", "mimic", "mujoco", "calibration", "safety_controller"),
    ]
)
_LEFT_OUT = frozenset({"gazebo", "transmission", "ros2_control", "material"})
"""Elements of URDF that describe no body."""
_EXPANDED = re.compile(r"\$\{|\$\((?:find|arg|eval|env|optenv|dirname|anon|cwd)\b")
_NAME = re.compile(r"[A-Za-z_]\w*")


@dataclass(frozen=True)
class Expanded:
    """A document without xacro.

    Attributes:
        root: the document.
        arguments: values of its arguments: those that were chosen, or the defaults.
        missing: names of files, and of macros in them, that are not in the upload.
        files: paths of the documents that it includes.
    """

    root: Element
    arguments: dict[str, str]
    missing: tuple[str, ...]
    files: frozenset[str]


def is_xacro(root: Element) -> bool:
    """Whether a document needs to be expanded."""
    elements = [root, *root.all()]
    return any(element.tag.startswith(_PREFIX) for element in elements) or (
        root.tag == "robot"
        and any(
            "$" in value and _EXPANDED.search(value)
            for element in elements
            for value in element.attributes.values()
        )
    )


class XacroExpansion:
    """Expands one document.

    Args:
        path: of the document.
        upload: the files.
        parse: returns the root of a document by its path.
        arguments: values of `$(arg …)` in place of the defaults.
        budget: of operations.
    """

    def __init__(
        self,
        path: str,
        upload: Upload,
        parse: Callable[[str], Element],
        arguments: Mapping[str, str],
        budget: Budget,
    ) -> None:
        self._main, self._upload, self._parse = path, upload, parse
        self._arguments = dict(arguments)
        self._declared = dict[str, str]()
        self._files, self._missing, self._included = [path], list[str](), set[str]()
        self._calls = self._depth = self._elements = 0
        self._budget = budget
        quiet = Function(lambda *_: "")
        functions: dict[str, Value] = {
            "load_yaml": Function(self._load_yaml),
            "arg": Function(lambda name: literal(self._argument_text(as_text(name)))),
            "abs_filename": Function(as_text),
            "dotify": Function(lambda mapping: mapping),
            "tokenize": GLOBALS["tokenize"],
            "find": Function(lambda name: f"/{self._upload.package_folder(as_text(name))}"),
            **dict.fromkeys(("message", "warning", "error", "print_location"), quiet),
        }
        self._texts = Texts(self._command, functions, budget)

    def expanded(self) -> Expanded:
        """Return the document without xacro.

        Raises:
            DamagedFile: naming the element and what is wrong, or which bound it exceeds.
        """
        root = self._document(self._main)
        try:
            result = self._copy(root, scope := Scope())
            self._expand_children(root, result, scope)
        except InvalidExpression as error:
            raise DamagedFile(f"{root.place}: {error}") from error
        return Expanded(
            result, self._declared, tuple(dict.fromkeys(self._missing)), frozenset(self._included)
        )

    def _document(self, path: str) -> Element:
        """Return a document; its elements know their file if it is not the main one."""
        file = "" if path == self._main else path

        def marked(element: Element) -> Element:
            self._budget.spend()
            children = [marked(child) for child in element]
            return replace(element, children=children, file=file)

        return marked(self._parse(path))

    # Elements

    def _expand_children(self, element: Element, parent: Element, scope: Scope) -> None:
        self._depth += 1
        for child in element:
            try:
                self._budget.spend()
                if self._depth > MAX_DEPTH:
                    raise InvalidExpression(f"macros and elements are over {MAX_DEPTH} deep")
                self._expand(child, parent, scope)
            except InvalidExpression as error:
                raise DamagedFile(f"{child.place}: {error}") from error
        self._depth -= 1

    def _expand(self, element: Element, parent: Element, scope: Scope) -> None:
        tag = self._plain_tag(element, scope)
        if tag is None:
            if element.tag not in _LEFT_OUT:
                self._elements += 1
                if self._elements > MAX_ELEMENTS:
                    raise InvalidExpression(f"expanded it has more than {MAX_ELEMENTS:,} elements")
                result = self._copy(element, scope)
                parent.children.append(result)
                self._expand_children(element, result, scope)
        elif tag in _HANDLERS:
            getattr(self, _HANDLERS[tag])(element, parent, scope)
        else:
            self._call(tag, element, parent, scope)

    def _plain_tag(self, element: Element, scope: Scope) -> str | None:
        """Return the tag without `xacro:`; None if it is no element of xacro."""
        tag = element.tag
        if tag.startswith(_PREFIX):
            return tag[len(_PREFIX) :]
        if tag in _BARE and (tag != "include" or "filename" in element.attributes):
            return tag
        return tag if tag not in _URDF and scope.find_macro(tag) else None

    def _copy(self, element: Element, scope: Scope) -> Element:
        attributes = {
            name: self._file_name(text, scope)
            if (element.tag, name) == ("mesh", "filename")
            else self._texts.text(text, scope)
            for name, text in element.attributes.items()
            if not name.startswith((_PREFIX, "xmlns"))
        }
        return replace(element, children=[], attributes=attributes)

    def _file_name(self, text: str, scope: Scope) -> str:
        """Return the path of a mesh; its end is enough to find it."""
        try:
            return self._texts.text(text, scope)
        except InvalidExpression:
            if text.endswith("}") or "/" not in text:
                raise
            return last_part(text)

    def _required(self, element: Element, name: str, scope: Scope) -> str:
        if name not in element.attributes:
            raise InvalidExpression(f"it needs the attribute {name}")
        return self._texts.text(element.attributes[name], scope)

    def _condition(self, element: Element, parent: Element, scope: Scope) -> None:
        text = element.attributes.get("value", "")
        holds = truth(self._texts.value(text, scope), text)
        if holds is not element.tag.endswith("unless"):
            self._expand_children(element, parent, scope)

    def _property(self, element: Element, _: Element, scope: Scope) -> None:
        attributes, name = element.attributes, self._required(element, "name", scope)
        if not _NAME.fullmatch(name) or name.startswith("__"):
            raise InvalidExpression(f"{quoted(name)!r} is no name of a property")
        if truth(self._texts.value(attributes.get("remove", "false"), scope), "remove"):
            for outer in scope.chain():
                outer.forget(name)
        elif "default" in attributes:
            if not scope.has(name):
                scope.set_text(name, attributes["default"])
        elif "value" not in attributes:
            _target(attributes.get("scope"), scope).blocks[f"**{name}"] = element.children
        else:
            target = _target(attributes.get("scope"), scope)
            if target is scope and attributes.get("lazy_eval", "true").lower() == "true":
                scope.set_text(name, attributes["value"])
            else:
                target.set_value(name, self._texts.value(attributes["value"], scope))

    def _declare_argument(self, element: Element, _: Element, scope: Scope) -> None:
        name = self._required(element, "name", scope)
        if name not in self._arguments and "default" in element.attributes:
            self._arguments[name] = self._required(element, "default", scope)
        self._declared.setdefault(name, self._arguments.get(name, ""))

    def _define_macro(self, element: Element, _: Element, scope: Scope) -> None:
        name = self._required(element, "name", scope).removeprefix(_PREFIX)
        scope.macros[name] = macro(element)

    def _insert_block(self, element: Element, parent: Element, scope: Scope) -> None:
        name = self._required(element, "name", scope)
        elements = scope.block(name)
        if elements is None:
            raise InvalidExpression(f"there is no block {quoted(name)!r}")
        self._expand_children(replace(element, children=elements), parent, scope)

    def _set_attribute(self, element: Element, parent: Element, scope: Scope) -> None:
        name = self._required(element, "name", scope)
        parent.attributes[name] = self._required(element, "value", scope)

    def _named_element(self, element: Element, parent: Element, scope: Scope) -> None:
        name = self._required(element, "xacro:name", scope)
        if not re.fullmatch(r"[A-Za-z_][\w.-]{0,100}", name):
            raise InvalidExpression(f"{quoted(name)!r} is no name of an element")
        self._expand(replace(element, tag=name), parent, scope)

    def _dynamic_call(self, element: Element, parent: Element, scope: Scope) -> None:
        name = self._required(element, "macro", scope)
        attributes = {n: text for n, text in element.attributes.items() if n != "macro"}
        self._call(name, replace(element, attributes=attributes), parent, scope)

    def _call(self, name: str, element: Element, parent: Element, scope: Scope) -> None:
        target = scope.find_macro(name)
        if target is None:
            if self._missing:  # it may be defined there
                self._missing.append(f"xacro:{name}")
                return
            raise InvalidExpression(f"there is no macro {quoted(name)!r}")
        self._calls += 1
        if self._calls > MAX_CALLS:
            raise InvalidExpression(f"it calls more than {MAX_CALLS:,} macros")
        called, around = target
        inner, waiting = Scope(around), [*called.parameters]
        for attribute, text in element.attributes.items():
            if attribute.startswith("xmlns"):
                continue
            if attribute not in waiting:
                raise InvalidExpression(
                    f"the macro {quoted(name)!r} has no parameter {quoted(attribute)!r}; it has: "
                    f"{listed(called.parameters)}"
                )
            waiting.remove(attribute)
            inner.set_value(attribute, self._texts.value(text, scope))
        holder = replace(element, children=[], attributes={})
        self._expand_children(element, holder, scope)
        blocks = [*holder.children]
        for parameter in waiting:
            if parameter.startswith("*"):
                if not blocks:
                    raise InvalidExpression(f"the macro {quoted(name)!r} needs {parameter}")
                block = blocks.pop(0)
                is_content = parameter.startswith("**")
                inner.blocks[parameter] = block.children if is_content else [block]
            else:
                inner.set_value(parameter, self._default(parameter, called.defaults, name, scope))
        self._expand_children(called.body, parent, inner)

    def _default(
        self,
        parameter: str,
        defaults: Mapping[str, tuple[bool, str | None]],
        name: str,
        scope: Scope,
    ) -> Value:
        forwards, text = defaults.get(parameter, (False, None))
        if forwards and scope.has(parameter):
            return self._texts.expression(parameter, scope)
        if text is None:
            raise InvalidExpression(f"the macro {quoted(name)!r} needs {quoted(parameter)}")
        return self._texts.value(text, scope)

    # Files and commands

    def _include(self, element: Element, parent: Element, scope: Scope) -> None:
        wanted = self._required(element, "filename", scope)
        if "ns" in element.attributes:
            name = self._required(element, "ns", scope)
            scope.spaces[name] = scope = Scope(scope, is_namespace=True)
        path = self._upload.find(wanted, self._files[-1])
        if path is None:
            self._missing.append(last_part(wanted))
            if not self._upload.is_zip:
                raise InvalidExpression(
                    f"it includes {quoted(last_part(wanted))}, which is another file: give both in "
                    "a zip or a folder"
                )
            return
        if path in self._files:
            raise InvalidExpression(f"{quoted(path)} includes itself")
        self._calls += 1
        if self._calls > MAX_CALLS:
            raise InvalidExpression(f"it includes more than {MAX_CALLS:,} files")
        self._included.add(path)
        self._files.append(path)
        self._expand_children(self._document(path), parent, scope)
        self._files.pop()

    def _load_yaml(self, wanted: Value) -> Value:
        path = self._upload.find(as_text(wanted), self._files[-1])
        if path is None:
            raise InvalidExpression(
                f"{quoted(last_part(as_text(wanted)))} is missing from the upload: give it in a zip"
            )

        def number(text: str) -> float:
            return float(self._texts.expression(text, Scope()))

        data = self._upload.read(path, MAX_YAML_BYTES)
        self._budget.spend(len(data))
        return read_yaml(data, number)

    def _argument_text(self, name: str) -> str:
        if name not in self._arguments:
            self._declared.setdefault(name, "")
            raise InvalidExpression(
                f"the argument {quoted(name)!r} has no default: choose its value by `arguments`"
            )
        self._declared.setdefault(name, self._arguments[name])
        return self._arguments[name]

    def _command(self, text: str) -> Value:
        """Return the value of `$(…)`."""
        words = text.split()
        kind, rest = (words[0], words[1:]) if words else ("", [])
        if kind in ("find", "find-pkg-share") and len(rest) == 1:
            return f"/{self._upload.package_folder(rest[0])}"
        if kind == "arg" and len(rest) == 1:
            return self._argument_text(rest[0])
        if kind == "eval":
            values = {name: literal(value) for name, value in self._arguments.items()}
            return self._texts.expression(text.strip()[len("eval") :], Scope(values=values))
        if kind == "optenv" and rest:
            return " ".join(rest[1:])
        if kind == "dirname":
            return f"/{self._files[-1].rpartition('/')[0]}"
        if kind == "env":
            raise InvalidExpression(f"$(env {quoted(' '.join(rest))}): no environment is read here")
        raise InvalidExpression(
            f"$({quoted(text)}) is not supported: expand it yourself (`pip install xacro`, "
            "`xacro robot.xacro > robot.urdf`), and give the result"
        )


def _target(where: str | None, scope: Scope) -> Scope:
    """Return the scope in which a property is set."""
    if where == "global":
        return [*scope.chain()][-1]
    if where == "parent" and scope.parent is not None:
        outer = scope.parent
        while not scope.is_namespace and outer.is_namespace and outer.parent is not None:
            outer = outer.parent
        return outer
    return scope


_HANDLERS = {
    "if": "_condition",
    "unless": "_condition",
    "property": "_property",
    "arg": "_declare_argument",
    "macro": "_define_macro",
    "insert_block": "_insert_block",
    "attribute": "_set_attribute",
    "element": "_named_element",
    "call": "_dynamic_call",
    "include": "_include",
}
"""Methods of `XacroExpansion` by the tags of xacro."""
