"""Kinds of settings: how one is declared, read from the text of its variable, and checked."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import Field, field, fields
from typing import TYPE_CHECKING, Any, NamedTuple

from hexapods.domain.errors import InvalidInput, UnknownName

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

PREFIX = "HEXAPODS_"
_KIND = "kind"
_YES, _NO = ("1", "true", "yes", "on"), ("0", "false", "no", "off")
_MAX_DIGITS = 18
Check = Callable[[str, str], None]
"""Raises InvalidInput if a text, the second argument, is not valid for a variable, the first."""


class WholeNumber(NamedTuple):
    """Kind of a setting that is a whole number.

    Attributes:
        least: lowest value.
        most: highest value; None for no limit.
        unit: what it counts, for the error, such as ` of megabytes`.
    """

    least: int
    most: int | None
    unit: str

    def read(self, variable: str, text: str) -> int:
        """Return the number that a text is; InvalidInput if it is none."""
        if not text.isascii() or not text.isdigit():
            raise InvalidInput(
                f"{variable} must be a whole number{self.unit}, {self._limits}, not {text!r}"
            )
        return int(text[:_MAX_DIGITS])

    def check(self, variable: str, number: int | None) -> None:
        """Raise InvalidInput if a number is out of the limits."""
        if number is None or (number >= self.least and (self.most is None or number <= self.most)):
            return
        raise InvalidInput(f"{variable} must be {self._limits}, not {number}")

    @property
    def _limits(self) -> str:
        if self.most is None:
            return f"at least {self.least}"
        return f"from {self.least} to {self.most}"


class Switch(NamedTuple):
    """Kind of a setting that is on or off.

    Attributes:
        option: help of the option of `hexapods serve` that turns it on; None if there is none.
    """

    option: str | None

    def read(self, variable: str, text: str) -> bool:
        """Return whether a text means on; InvalidInput if it means neither on nor off."""
        if text.lower() not in (*_YES, *_NO):
            raise InvalidInput(f"{variable} must be 1 or 0, not {text!r}")
        return text.lower() in _YES

    def check(self, variable: str, is_on: bool) -> None:
        """Accept both."""


class OneOf(NamedTuple):
    """Kind of a setting that has one of some values.

    Attributes:
        values: which.
    """

    values: Sequence[str]

    def read(self, variable: str, text: str) -> str:
        """Return the text."""
        del variable
        return text

    def check(self, variable: str, value: str) -> None:
        """Raise UnknownName if a value is none of them."""
        if value not in self.values:
            raise UnknownName(variable, value, self.values)


class Text(NamedTuple):
    """Kind of a setting that is a text.

    Attributes:
        test: which texts there are; None for any.
    """

    test: Check | None

    def read(self, variable: str, text: str) -> str:
        """Return the text."""
        del variable
        return text

    def check(self, variable: str, text: str | None) -> None:
        """Raise InvalidInput if the text is not valid."""
        if text is not None and self.test is not None:
            self.test(variable, text)


class Names(NamedTuple):
    """Kind of a setting that is a list of names, separated by commas.

    Attributes:
        test: which names there are; None for any.
        ignores_case: whether the names are read in lower case.
    """

    test: Check | None
    ignores_case: bool

    def read(self, variable: str, text: str) -> tuple[str, ...]:
        """Return the names in a text, without empty ones."""
        del variable
        names = (text.lower() if self.ignores_case else text).split(",")
        return tuple(filter(None, map(str.strip, names)))

    def check(self, variable: str, names: Sequence[str]) -> None:
        """Raise InvalidInput if one of the names is not valid."""
        for name in names:
            if self.test is not None:
                self.test(variable, name)


Kind = WholeNumber | Switch | OneOf | Text | Names


def whole_number(
    default: int | None, least: int, most: int | None = None, *, unit: str = ""
) -> Any:
    """Declare a field that is a whole number; see `WholeNumber`."""
    return field(default=default, metadata={_KIND: WholeNumber(least, most, unit)})


def switch(*, option: str | None = None) -> Any:
    """Declare a field that is off unless it is turned on; see `Switch`."""
    return field(default=False, metadata={_KIND: Switch(option)})


def choice(default: str, values: Sequence[str]) -> Any:
    """Declare a field that has one of some values."""
    return field(default=default, metadata={_KIND: OneOf(values)})


def text(default: str | None, test: Check | None = None, *, is_secret: bool = False) -> Any:
    """Declare a field that is a text; see `Text`. `repr` leaves a secret out."""
    return field(default=default, repr=not is_secret, metadata={_KIND: Text(test)})


def names(test: Check | None = None, *, ignores_case: bool = False) -> Any:
    """Declare a field that is a list of names, empty by default; see `Names`."""
    return field(default=(), metadata={_KIND: Names(test, ignores_case)})


def variable_of(name: str) -> str:
    """Return the environment variable of a setting."""
    return PREFIX + name.upper()


def kind_of(declared: Field[Any]) -> Kind | None:
    """Return the kind of a field; None if it has none: its text is its value, unchecked."""
    kind: Kind | None = declared.metadata.get(_KIND)
    return kind


def read_texts(settings: "type[DataclassInstance]", values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values that a class of settings has fields for, texts read as their kinds say.

    Args:
        settings: the class, a dataclass.
        values: by name of the setting: text of its variable, or a value.

    Raises:
        InvalidInput: for a text that is no value of its kind.
    """
    read: dict[str, Any] = {}
    for declared in fields(settings):
        value = values.get(declared.name)
        kind = kind_of(declared)
        if isinstance(value, str) and kind is not None:
            value = kind.read(variable_of(declared.name), value)
        if value is not None:
            read[declared.name] = value
    return read


def check_kinds(settings: "DataclassInstance") -> None:
    """Check the values of settings by their kinds.

    Raises:
        InvalidInput: for a value that its kind does not have.
    """
    for declared in fields(settings):
        if (kind := kind_of(declared)) is not None:
            kind.check(variable_of(declared.name), getattr(settings, declared.name))
