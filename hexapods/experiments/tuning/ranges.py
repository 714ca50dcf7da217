"""Search range of a tuned setting: limits or a list of values, from its declaration."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.settings import REQUIRED, DeclaredSetting, Value

LOG_RATIO = 100
"""A range of positive numbers is searched on a logarithmic scale if its ends differ by this factor
or more."""
_MARGIN = 1e-3
"""Distance that the search keeps from an exclusive limit, as a share of the range."""
_BELOW_KNOWN = 10
"""Where 0 is an exclusive limit, the search begins at this fraction of the lowest value that the
declaration names."""
_DIGITS = 4


@dataclass(frozen=True, kw_only=True)
class SearchRange:
    """Values of a setting among which to search: a list, or all numbers between two.

    Attributes:
        name: name of the setting.
        choices: the values of a list; empty for a range of numbers.
        low, high: ends of a range of numbers, both inclusive.
        is_whole: whether only integers are valid.
    """

    name: str
    choices: tuple[Value, ...] = ()
    low: float = 0.0
    high: float = 0.0
    is_whole: bool = False

    @property
    def is_logarithmic(self) -> bool:
        """Whether the range is searched on a logarithmic scale."""
        return not self.choices and self.low > 0 and self.high / self.low >= LOG_RATIO

    def contains(self, value: Any) -> bool:
        """Whether a value of the setting is one of those to search."""
        if self.choices:
            return value in self.choices
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        return is_number and self.low <= value <= self.high

    def rounded(self, value: Any) -> Any:
        """Round a number to four significant digits, within the range, so that it can be typed."""
        if self.choices or self.is_whole:
            return value
        return min(max(float(f"{value:.{_DIGITS}g}"), self.low), self.high)

    def __str__(self) -> str:
        """Write it as `parse_range` reads it: `alpha=0.01:1.0`, `prior=none,kinematic`."""
        if self.choices:
            return f"{self.name}={','.join(map(_text, self.choices))}"
        return f"{self.name}={_text(self.low)}:{_text(self.high)}"


def setting_name(text: str) -> str:
    """Return the name of a setting that may be written as its option is: `planning-steps`."""
    return text.replace("-", "_")


def declared_range(setting: DeclaredSetting) -> SearchRange | None:
    """Return where to search a setting if nothing else is said; None if that is not declared.

    All choices of a literal or a boolean; all numbers within the limits of a number that has both.
    """
    found = None
    if setting.is_number:
        low, high = _inner_limits(setting)
        if low is not None and high is not None:
            found = SearchRange(name=setting.name, low=low, high=high, is_whole=setting.is_whole)
    elif setting.choices:
        found = SearchRange(name=setting.name, choices=setting.choices)
    elif bool in setting.kinds:
        found = SearchRange(name=setting.name, choices=(False, True))
    return found if found is not None and found.contains(setting.default) else None


def parse_range(text: str, settings: Mapping[str, DeclaredSetting]) -> SearchRange:
    """Parse `NAME=LOW:HIGH` or `NAME=VALUE,VALUE,…`.

    Args:
        text: the range.
        settings: the settings of the agent by name.

    Raises:
        UnknownName: if there is no such setting.
        InvalidInput: if a value is not valid, or the range does not contain the default, which is
            tried first.
    """
    name, equals, values = (part.strip() for part in text.partition("="))
    name = setting_name(name)
    if not equals or not values:
        raise InvalidInput(f"a range is NAME=LOW:HIGH or NAME=VALUE,VALUE, not {text!r}")
    if name not in settings:
        raise UnknownName("setting", name, settings)
    setting = settings[name]
    found = _parse_numbers(setting, values) if ":" in values else _parse_list(setting, values)
    if setting.default is not REQUIRED and not found.contains(setting.default):
        raise InvalidInput(
            f"the range of {name} must contain its default, {_text(setting.default)}, which is "
            "tried first"
        )
    return found


def _parse_numbers(setting: DeclaredSetting, values: str) -> SearchRange:
    if not setting.is_number:
        raise InvalidInput(f"{setting.name} is no number; list its values: {setting.valid}")
    ends = [setting.normalized(setting.parse(part.strip())) for part in values.split(":")]
    numbers = [end for end in ends if isinstance(end, int | float)]
    if len(ends) != 2 or len(numbers) != 2:
        raise InvalidInput(f"the range of {setting.name} must be LOW:HIGH, not {values!r}")
    low, high = numbers
    if low >= high:
        raise InvalidInput(f"{setting.name}={values}: LOW must be below HIGH")
    return SearchRange(name=setting.name, low=low, high=high, is_whole=setting.is_whole)


def _parse_list(setting: DeclaredSetting, values: str) -> SearchRange:
    choices = [setting.normalized(setting.parse(part.strip())) for part in values.split(",")]
    if len(set(choices)) < max(2, len(choices)):
        raise InvalidInput(f"the list of {setting.name} must have two or more different values")
    return SearchRange(name=setting.name, choices=tuple(choices))


def _inner_limits(setting: DeclaredSetting) -> tuple[float | None, float | None]:
    """Return the least and the greatest number to try; exclusive limits are kept at a distance."""
    low, high = setting.low, setting.high
    if low is None or high is None:
        return None, None
    if setting.is_whole:
        return int(low) + setting.excludes_low, int(high) - setting.excludes_high
    low, high = float(low), float(high)
    margin = _MARGIN * (high - low)
    known = [x for x in (setting.default, *setting.about.examples) if isinstance(x, int | float)]
    if setting.excludes_low:
        low = low + margin if low or not known else _rounded(min(known) / _BELOW_KNOWN)
    return low, _rounded(high - margin) if setting.excludes_high else high


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")


def _text(value: Value) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
