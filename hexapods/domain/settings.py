"""Settings: values that a user may choose, each declared once, where it is used.

A setting is a keyword parameter of an agent's constructor, or a field of a config dataclass, whose
type is annotated with its limits and with a `Setting`:

    alpha: Annotated[float, Gt(0), Le(1), Setting(title="Learning rate", help="…")] = 0.3

`declared_parameters` and `declared_fields` find the declarations. From them follow validation,
request fields and error messages, `GET /options`, options of the command line, controls on the
page, the grid of a sweep, and fields of checkpoints and archives.
"""

import inspect
import math
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import MISSING, dataclass, fields, replace
from functools import cache, cached_property, partial
from inspect import Parameter
from types import MappingProxyType, NoneType, UnionType
from typing import Annotated, Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

from annotated_types import Ge, Gt, Le, Lt, MultipleOf

from hexapods.domain.checks import Limit, bound_of, parse_number, satisfies
from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.records import plain_form

Value = float | int | str | bool | None
V = TypeVar("V")
REQUIRED = inspect.Parameter.empty
"""Default of a setting without a default."""
_VARIADIC = (Parameter.VAR_POSITIONAL, Parameter.VAR_KEYWORD)
_PLAIN_TYPES = (bool, int, float, str, NoneType)
MAX_SETTING_NAME = 60
MAX_TEXT = 200


@dataclass(frozen=True, kw_only=True)
class Setting:
    """Description of a setting for users, and whether it may change during a run.

    Attributes:
        title: label of its control.
        help: description, one sentence.
        symbol: conventional symbol, such as α.
        quantity: the word of the title that the symbol stands for, if it is not the whole title:
            `exploration` of `Final exploration`, which is `Final ε` in short.
        phrase: format string for a value in a report, such as `{} divisions`; by default the
            symbol or title, and the value.
        unit: unit of a number, such as m.
        live: whether it may change while a run is active; the agent's `tune` receives changes.
        examples: example values for a sweep.
        choice_titles: titles of the words of a `Literal`, in their order; by default the words.
    """

    title: str
    help: str
    symbol: str | None = None
    quantity: str | None = None
    phrase: str | None = None
    unit: str | None = None
    live: bool = False
    examples: tuple[float, ...] = ()
    choice_titles: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "examples", tuple(self.examples))

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        """Describe the value to Pydantic, but leave its validation to `DeclaredSetting.check`."""
        native = handler(source)

        def describe(_: Any, schema_of: Any) -> dict[str, Any]:
            return {**schema_of(native), "title": self.title, "description": self.help}

        return plain_form(lambda value: value, lambda value: value, describe)


@dataclass(frozen=True)
class DeclaredSetting:
    """Declaration of a setting, with validation, parsing and formatting of its values.

    Attributes:
        name: name of the parameter or field.
        annotation: its type with all metadata, as Pydantic and Hypothesis accept it.
        default: default value; `REQUIRED` if it has none.
        about: description for users.
    """

    name: str
    annotation: Any
    default: Any
    about: Setting

    @cached_property
    def kinds(self) -> frozenset[type]:
        """Types of valid values, a subset of bool, int, float, str and NoneType."""
        return frozenset(_kinds(self.annotation))

    @cached_property
    def choices(self) -> tuple[str, ...]:
        """The valid strings of a `Literal` type; empty for other types."""
        return tuple(literal for literal in _literals(self.annotation) if isinstance(literal, str))

    @cached_property
    def limits(self) -> tuple[Limit, ...]:
        """Limits of valid numbers."""
        return tuple(_limits(self.annotation))

    @property
    def is_number(self) -> bool:
        """Whether numbers are valid."""
        return bool(self.kinds & {int, float})

    @property
    def is_whole(self) -> bool:
        """Whether integers are the only valid numbers."""
        return int in self.kinds and float not in self.kinds

    @property
    def low(self) -> float | None:
        """Lower limit, inclusive or exclusive; None without one."""
        return next((bound_of(limit) for limit in self.limits if isinstance(limit, Ge | Gt)), None)

    @property
    def high(self) -> float | None:
        """Upper limit, inclusive or exclusive; None without one."""
        return next((bound_of(limit) for limit in self.limits if isinstance(limit, Le | Lt)), None)

    @property
    def excludes_low(self) -> bool:
        """Whether the lower limit is exclusive."""
        return any(isinstance(limit, Gt) for limit in self.limits)

    @property
    def excludes_high(self) -> bool:
        """Whether the upper limit is exclusive."""
        return any(isinstance(limit, Lt) for limit in self.limits)

    @cached_property
    def valid(self) -> str:
        """Description of the valid values for error messages, to follow "must be"."""
        forms = list(self.choices)
        if self.is_whole:
            # The unit of a count is clear from its name.
            forms.append(" ".join([self._whole_number(), *self._range()]))
        elif self.is_number:
            unit = [self.about.unit] if self.about.unit else []
            forms.append(" ".join(["a number", *self._range(), *unit]))
        if bool in self.kinds:
            forms.append("true or false")
        if str in self.kinds:
            forms.append(f"text of at most {MAX_TEXT} characters")
        return ", or ".join(forms)

    def check(self, value: Any) -> None:
        """Check that a value is valid.

        Raises:
            InvalidInput: if it is not; the message names what is.
        """
        if not self.allows(value):
            formatted = f"{value:,}" if type(value) in (int, float) else repr(value)[:80]
            raise InvalidInput(f"{self.name} must be {self.valid}, not {formatted}")

    def allows(self, value: Any) -> bool:
        """Whether a value is valid."""
        if value is None or isinstance(value, bool):
            return type(value) in self.kinds
        if isinstance(value, str):
            return value in self.choices or (str in self.kinds and len(value) <= MAX_TEXT)
        if not isinstance(value, int | float) or not self.is_number:
            return False
        # No whole number that `float` cannot take either.
        is_of_kind = isinstance(value, int) if self.is_whole else abs(value) <= sys.float_info.max
        return is_of_kind and all(satisfies(limit, value) for limit in self.limits)

    def normalized(self, value: Any) -> Any:
        """Return a value converted to the type of the setting: 2 to 2.0, or 2.0 to 2.

        Raises:
            InvalidInput: if it is not valid.
        """
        if self.is_whole and isinstance(value, float) and value.is_integer():
            value = int(value)
        self.check(value)
        if type(value) is int and int not in self.kinds:
            return float(value)
        return value

    def describe(self, value: Any) -> str:
        """Format a value for a report: `α 0.3`."""
        name = self.about.symbol or self.about.title.lower()
        kind = {float: "g", int: ","}.get(type(value), "")
        return (self.about.phrase or name + "\u00a0{}").format(format(value, kind))

    def parse(self, text: str) -> Value:
        """Parse a value from a command line or a URL.

        Raises:
            InvalidInput: if it is not valid; the message names what is.
        """
        value: Value = text
        if text not in self.choices:
            if bool in self.kinds and text in ("true", "false"):
                value = text == "true"
            elif self.is_number:
                value = parse_number(text, self.is_whole)
        self.check(value)
        return value

    def _whole_number(self) -> str:
        multiples = (bound_of(limit) for limit in self.limits if isinstance(limit, MultipleOf))
        multiple = next(multiples, None)
        if multiple is None:
            return "a whole number"
        number = "an even number" if multiple == 2 else f"a multiple of {multiple:g}"
        return f"{number} of {self.about.unit}" if self.about.unit else number

    def _range(self) -> list[str]:
        low, high = (None if bound is None else f"{bound:,.15g}" for bound in (self.low, self.high))
        if low is None and high is None:
            return []
        if high is None:
            return [f"over {low}" if self.excludes_low else f"of at least {low}"]
        upper = f"under {high}" if self.excludes_high else f"at most {high}"
        if low is None:
            return [upper if self.excludes_high else f"of {upper}"]
        if self.excludes_low:
            return [f"over {low} and {upper}"]
        return [f"from {low} to {'under ' if self.excludes_high else ''}{high}"]


@cache
def parameters_of(
    function: Callable[..., Any], method: str = "__init__"
) -> Mapping[str, Parameter]:
    """Return the named parameters of a function, or of a method of a class.

    Those of the base class are included if the method has a `**` parameter.
    """
    return {name: parameter for name, (parameter, _) in _parameters(function, method).items()}


def takes_any(function: Callable[..., Any], method: str = "__init__") -> bool:
    """Whether a function, or a method of a class, takes any keyword argument."""
    return _has_rest(_call_chain(function, method)[-1])


@cache
def declared_parameters(
    function: Callable[..., Any], method: str = "__init__"
) -> Mapping[str, DeclaredSetting]:
    """Return the settings among the parameters that `parameters_of` returns, in order."""
    return {
        name: declare(name, annotation, parameter.default)
        for name, (parameter, annotation) in _parameters(function, method).items()
        if _setting_of(annotation) is not None
    }


def _parameters(function: Callable[..., Any], method: str) -> Mapping[str, tuple[Parameter, Any]]:
    """Return the parameters with their annotations, those of base classes first."""
    parameters: dict[str, tuple[Parameter, Any]] = {}
    for called in _call_chain(function, method):
        hints = _hints(called)
        named = {
            name: (parameter, hints.get(name))
            for name, parameter in inspect.signature(called).parameters.items()
            if parameter.kind not in _VARIADIC and name != "self"
        }
        parameters = {**named, **parameters}
    return parameters


def _call_chain(function: Callable[..., Any], method: str) -> list[Callable[..., Any]]:
    """Return the functions that a call passes through, each of which passes `**` to the next.

    For a class these are its method and those of its bases; otherwise the function alone.
    """
    if not isinstance(function, type):
        return [function]
    chain: list[Callable[..., Any]] = []
    for base in function.__mro__[:-1]:
        if method in vars(base):
            chain.append(vars(base)[method])
            if not _has_rest(chain[-1]):
                break
    return chain or [function]


def _has_rest(function: Callable[..., Any]) -> bool:
    parameters = inspect.signature(function).parameters.values()
    return any(parameter.kind is Parameter.VAR_KEYWORD for parameter in parameters)


def _hints(function: Callable[..., Any]) -> Mapping[str, Any]:
    """Resolve a function's annotations; those of imports for type checkers only are left out."""
    target = function.func if isinstance(function, partial) else function
    target = target.__init__ if isinstance(target, type) else target  # type: ignore[misc]
    hints: dict[str, Any] = {}
    for name, annotation in getattr(target, "__annotations__", {}).items():
        holder = type("Holder", (), {"__annotations__": {name: annotation}})
        with suppress(AttributeError, NameError, SyntaxError, TypeError):
            namespace = getattr(target, "__globals__", {})
            hints |= get_type_hints(holder, globalns=namespace, include_extras=True)
    return hints


@cache
def declared_fields(config: type) -> Mapping[str, DeclaredSetting]:
    """Return the settings among the fields of a dataclass, in order."""
    hints = get_type_hints(config, include_extras=True)
    return {
        f.name: declare(f.name, hints[f.name], REQUIRED if f.default is MISSING else f.default)
        for f in fields(config)
        if _setting_of(hints[f.name]) is not None
    }


def declare(name: str, annotation: Any, default: Any = REQUIRED) -> DeclaredSetting:
    """Create a declared setting from a name and an annotation that includes a `Setting`."""
    about = _setting_of(annotation)
    if about is None:
        raise TypeError(f"{name} has no Setting in its annotation")
    return DeclaredSetting(name, annotation, default, about)


def required(setting: DeclaredSetting) -> DeclaredSetting:
    """Return an optional setting of a function as a required one, which must not be None."""
    members = get_args(setting.annotation) if _is_union(setting.annotation) else ()
    kinds = tuple(kind for kind in members if kind is not NoneType) or (setting.annotation,)
    return replace(setting, annotation=Union[kinds], default=REQUIRED)  # noqa: UP007


class SettingValues(Mapping[str, V]):
    """Values of settings by name: an immutable, hashable, ordered mapping."""

    def __init__(self, values: Mapping[str, V] = MappingProxyType({})) -> None:
        """Copy the values.

        Raises:
            InvalidInput: if a name is no identifier, or a value is not plain.
        """
        for name, value in values.items():
            if not name.isidentifier() or len(name) > MAX_SETTING_NAME:
                raise InvalidInput(f"{name[:MAX_SETTING_NAME]!r} cannot be the name of a setting")
            if not _is_value(value):
                raise InvalidInput(f"{name} must be a number, text, true or false")
        self._values = dict(values)

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: Any) -> Any:
        """Read and write a JSON object; its values are lists if those of the type are tuples."""
        are_lists = get_origin(next(iter(get_args(source)), None)) is tuple

        def read(data: Any) -> "SettingValues[Any]":
            if isinstance(data, SettingValues):
                return data
            if not isinstance(data, Mapping):
                raise InvalidInput(f"settings are given by name, not as {data!r}"[:200])
            for name, value in data.items():
                if isinstance(value, list | tuple) != are_lists:
                    kind = "a list of values" if are_lists else "a number, text, true or false"
                    raise InvalidInput(f"{name} must be {kind}")
            values: dict[str, Any] = {k: tuple(v) if are_lists else v for k, v in data.items()}
            return cls(values)

        def write(values: "SettingValues[Any]") -> dict[str, Any]:
            return {k: list(v) if are_lists else v for k, v in values.items()}

        def describe(_: Any, schema_of: Any) -> dict[str, Any]:
            values = dict[str, list[Value]] if are_lists else dict[str, Value]
            shape = schema_of(handler.generate_schema(values))
            return {**shape, "description": "settings of the agent, by name"}

        return plain_form(read, write, describe)

    def __getitem__(self, name: str) -> V:
        return self._values[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __hash__(self) -> int:
        return hash(frozenset(self._values.items()))

    def __or__(self, changes: Mapping[str, V]) -> "SettingValues[V]":
        return SettingValues({**self._values, **changes})

    def __repr__(self) -> str:
        return f"SettingValues({self._values!r})"


def complete(
    settings: Mapping[str, DeclaredSetting], values: Mapping[str, Any], owner: str
) -> SettingValues[Value]:
    """Validate values of settings, and add the defaults of those without a value.

    Args:
        settings: the declarations by name, which determine the order of the values.
        values: values by name.
        owner: name of the owner of the settings, for error messages.

    Raises:
        UnknownName: if a name is not one of the settings.
        InvalidInput: if a value is invalid, or a required one is missing.
    """
    for name in values:
        if name not in settings:
            if not settings:
                raise InvalidInput(f"{owner} has no settings, so none named {name!r}")
            raise UnknownName(f"setting of {owner}", name, settings)
    for name, setting in settings.items():
        if name not in values and setting.default is REQUIRED:
            raise InvalidInput(f"{owner} needs {name}, {setting.valid}")
    return SettingValues(
        {
            name: setting.normalized(values[name]) if name in values else setting.default
            for name, setting in settings.items()
        }
    )


def _setting_of(annotation: Any) -> Setting | None:
    """Return the `Setting` in an annotation; in an optional one it is one level deeper."""
    members = get_args(annotation) if _is_union(annotation) else (annotation,)
    metadata = (item for member in members for item in getattr(member, "__metadata__", ()))
    return next((item for item in metadata if isinstance(item, Setting)), None)


def _is_union(annotation: Any) -> bool:
    return get_origin(annotation) in (Union, UnionType)


def _is_value(value: Any) -> bool:
    if isinstance(value, tuple):
        return all(_is_value(item) for item in value)
    return isinstance(value, bool | int | str | NoneType) or (
        isinstance(value, float) and math.isfinite(value)
    )


def _kinds(annotation: Any) -> Iterator[type]:
    origin = get_origin(annotation)
    if origin is Annotated:
        yield from _kinds(get_args(annotation)[0])
    elif origin in (Union, UnionType):
        for argument in get_args(annotation):
            yield from _kinds(argument)
    elif annotation in (None, *_PLAIN_TYPES):
        yield NoneType if annotation is None else annotation
    elif origin is not Literal:
        raise TypeError(f"a setting is a number, text, boolean, choice or None, not {annotation}")


def _literals(annotation: Any) -> Iterator[Any]:
    if get_origin(annotation) is Literal:
        yield from get_args(annotation)
    else:
        for argument in get_args(annotation):
            yield from _literals(argument)


def _limits(annotation: Any) -> Iterator[Limit]:
    for argument in (*getattr(annotation, "__metadata__", ()), *get_args(annotation)):
        if isinstance(argument, Limit):
            yield argument
        elif get_origin(argument) is not None:
            yield from _limits(argument)
