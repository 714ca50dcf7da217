"""Settings: values that a person may choose, each declared once, where it is used.

A setting is a keyword parameter of an agent's constructor, or a field of a config dataclass, whose
type is annotated with its limits and with a `Setting`:

    alpha: Annotated[float, Gt(0), Le(1), Setting(title="Learning rate", help="…")] = 0.3

`declared_parameters` and `declared_fields` find the declarations. From those of a training follow
validation, the types and descriptions of request fields, refusals, `GET /options`, options of the
command line, and labels and limits on the page.
"""

import inspect
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import MISSING, asdict, dataclass, fields
from functools import cache, cached_property
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

from annotated_types import Ge, Gt, Le, Lt

from app.domain.errors import InvalidInput

Value = float | int | str | bool | None
Limit = Ge | Gt | Le | Lt
REQUIRED = inspect.Parameter.empty
"""The default of a setting that has none."""
_KINDS = (bool, int, float, str, NoneType)


@dataclass(frozen=True, kw_only=True)
class Setting:
    """Describes a setting to people, and says whether it may change during a run.

    Attributes:
        title: the label of its control.
        help: one sentence.
        symbol: the field's letter for it, such as α.
        unit: what a number counts or measures, such as m.
        live: whether it may change while a run is active; the agent's `tune` receives changes.
        examples: values that a sweep might compare.
    """

    title: str
    help: str
    symbol: str | None = None
    unit: str | None = None
    live: bool = False
    examples: tuple[float, ...] = ()


@dataclass(frozen=True)
class DeclaredSetting:
    """A setting with its declaration.

    Attributes:
        name: of the parameter or field.
        annotation: its type with all metadata, as Pydantic and Hypothesis take it.
        default: `REQUIRED` if it has none.
        about: its description.
    """

    name: str
    annotation: Any
    default: Any
    about: Setting

    @cached_property
    def kinds(self) -> frozenset[type]:
        """The plain types of valid values: of bool, int, float, str and NoneType."""
        return frozenset(_kinds(self.annotation))

    @cached_property
    def choices(self) -> tuple[str, ...]:
        """The valid words, if only certain words are valid."""
        return tuple(word for word in _literals(self.annotation) if isinstance(word, str))

    @cached_property
    def limits(self) -> tuple[Limit, ...]:
        """The limits of valid numbers."""
        return tuple(_limits(self.annotation))

    @property
    def is_number(self) -> bool:
        """Whether numbers are valid."""
        return bool(self.kinds & {int, float})

    @property
    def is_whole(self) -> bool:
        """Whether of all numbers only whole ones are valid."""
        return int in self.kinds and float not in self.kinds

    @property
    def low(self) -> float | None:
        """The lower limit, whether it is itself valid or not."""
        return next((_bound(x) for x in self.limits if isinstance(x, Ge | Gt)), None)

    @property
    def high(self) -> float | None:
        """The upper limit, whether it is itself valid or not."""
        return next((_bound(x) for x in self.limits if isinstance(x, Le | Lt)), None)

    @property
    def excludes_low(self) -> bool:
        """Whether the lower limit itself is not valid."""
        return any(isinstance(limit, Gt) for limit in self.limits)

    @property
    def excludes_high(self) -> bool:
        """Whether the upper limit itself is not valid."""
        return any(isinstance(limit, Lt) for limit in self.limits)

    @cached_property
    def valid(self) -> str:
        """The valid values in words that follow "must be"."""
        parts = list(self.choices)
        if self.is_whole:
            # Of a count the unit is clear from its name.
            parts.append(" ".join(["a whole number", *self._range()]))
        elif self.is_number:
            unit = [self.about.unit] if self.about.unit else []
            parts.append(" ".join(["a number", *self._range(), *unit]))
        if bool in self.kinds:
            parts.append("true or false")
        if str in self.kinds:
            parts.append("text")
        return ", or ".join(parts)

    def check(self, value: Any) -> None:
        """Check that a value is valid.

        Raises:
            InvalidInput: if it is not; the message names what is.
        """
        if not self._is_valid(value):
            shown = f"{value:,}" if type(value) in (int, float) else repr(value)[:80]
            raise InvalidInput(f"{self.name} must be {self.valid}, not {shown}")

    def parse(self, text: str) -> Value:
        """Parse a value as typed on a command line or in an address.

        Raises:
            InvalidInput: if it is not valid; the message names what is.
        """
        value: Value = text
        if text not in self.choices:
            if bool in self.kinds and text in ("true", "false"):
                value = text == "true"
            elif self.is_number:
                value = _parsed_number(text, self.is_whole)
        self.check(value)
        return value

    def _is_valid(self, value: Any) -> bool:
        if value is None or isinstance(value, bool):
            return type(value) in self.kinds
        if isinstance(value, str):
            return value in self.choices or str in self.kinds
        if not isinstance(value, int | float) or not self.is_number:
            return False
        if isinstance(value, float) and not math.isfinite(value):
            return False
        if self.is_whole and not isinstance(value, int):
            return False
        return all(_holds(limit, value) for limit in self.limits)

    def _range(self) -> list[str]:
        low, high = (None if x is None else f"{x:,.15g}" for x in (self.low, self.high))
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
def declared_parameters(function: Callable[..., Any]) -> Mapping[str, DeclaredSetting]:
    """Find the settings among the parameters of a constructor or function, in their order."""
    target = function.__init__ if isinstance(function, type) else function  # type: ignore[misc]
    hints = get_type_hints(target, include_extras=True)
    parameters = inspect.signature(function).parameters.values()
    return _declared((p.name, hints.get(p.name), p.default) for p in parameters)


@cache
def declared_fields(config: type) -> Mapping[str, DeclaredSetting]:
    """Find the settings among the fields of a dataclass, in their order."""
    hints = get_type_hints(config, include_extras=True)
    return _declared(
        (f.name, hints[f.name], REQUIRED if f.default is MISSING else f.default)
        for f in fields(config)
    )


def declare(name: str, annotation: Any, default: Any = REQUIRED) -> DeclaredSetting:
    """Make a declared setting of a name and an annotation that includes a `Setting`."""
    (about,) = (one for one in annotation.__metadata__ if isinstance(one, Setting))
    return DeclaredSetting(name, annotation, default, about)


def _declared(candidates: Iterable[tuple[str, Any, Any]]) -> dict[str, DeclaredSetting]:
    return {
        name: declare(name, annotation, default)
        for name, annotation, default in candidates
        if any(isinstance(one, Setting) for one in getattr(annotation, "__metadata__", ()))
    }


def _kinds(annotation: Any) -> Iterator[type]:
    origin = get_origin(annotation)
    if origin is Annotated:
        yield from _kinds(get_args(annotation)[0])
    elif origin in (Union, UnionType):
        for one in get_args(annotation):
            yield from _kinds(one)
    elif annotation in (None, *_KINDS):
        yield NoneType if annotation is None else annotation
    elif origin is not Literal:
        raise TypeError(f"a setting is a number, text, boolean, choice or None, not {annotation}")


def _literals(annotation: Any) -> Iterator[Any]:
    if get_origin(annotation) is Literal:
        yield from get_args(annotation)
    else:
        for one in get_args(annotation):
            yield from _literals(one)


def _limits(annotation: Any) -> Iterator[Limit]:
    for one in (*getattr(annotation, "__metadata__", ()), *get_args(annotation)):
        if isinstance(one, Ge | Gt | Le | Lt):
            yield one
        elif get_origin(one) is not None:
            yield from _limits(one)


def _bound(limit: Limit) -> float:
    (bound,) = asdict(limit).values()
    return bound  # type: ignore[no-any-return]


def _holds(limit: Limit, value: float) -> bool:
    bound = _bound(limit)
    if isinstance(limit, Gt):
        return value > bound
    if isinstance(limit, Ge):
        return value >= bound
    return value < bound if isinstance(limit, Lt) else value <= bound


def _parsed_number(text: str, is_whole: bool) -> Value:
    """The number, or the text itself if it is none."""
    try:
        return int(text) if is_whole else float(text)
    except ValueError:
        return text
