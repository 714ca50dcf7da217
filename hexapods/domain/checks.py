"""Validation of user input: whole numbers, limits annotated in a type, formats of files."""

from dataclasses import asdict

from annotated_types import Ge, Gt, Le, Lt, MultipleOf

from hexapods.domain.errors import InvalidInput, OtherFormat

Limit = Ge | Gt | Le | Lt | MultipleOf
_MAX_SHOWN = 40


def check_whole(name: str, value: int, low: int, high: int | None) -> None:
    """Check that a value is an integer from `low` to `high`; `high` None is no upper limit.

    Raises:
        InvalidInput: if it is not.
    """
    if isinstance(value, bool) or not isinstance(value, int):
        raise InvalidInput(f"{name} must be a whole number, not {value!r}")
    if value < low or (high is not None and value > high):
        limits = f"at least {low}" if high is None else f"from {low} to {high:,}"
        raise InvalidInput(f"{name} must be {limits}, not {value:,}")


def check_format(label: str, version: object, supported: int | str) -> None:
    """Check the version of a file's format; each format has one that is read.

    Args:
        label: name of the file.
        version: the version in the file, untrusted.
        supported: the version that this program reads.

    Raises:
        OtherFormat: if the versions differ, or the file has none.
    """
    if type(version) is not type(supported) or version != supported:
        raise OtherFormat(
            f"{label} has format {repr(version)[:_MAX_SHOWN]}; this version reads {supported!r} "
            "alone, and leaves the file as it is: use the version of Racing Hexapods that wrote "
            "it, or write it again with this one"
        )


def bound_of(limit: Limit) -> float:
    """Return the number of a limit."""
    (bound,) = asdict(limit).values()
    return bound  # type: ignore[no-any-return]


def satisfies(limit: Limit, value: float) -> bool:
    """Whether a number is within a limit."""
    bound = bound_of(limit)
    if isinstance(limit, MultipleOf):
        return value % bound == 0
    if isinstance(limit, Gt):
        return value > bound
    if isinstance(limit, Ge):
        return value >= bound
    return value < bound if isinstance(limit, Lt) else value <= bound


def parse_number(text: str, is_whole: bool) -> float | int | str:
    """Parse a number; return the text itself if it is not one."""
    try:
        return int(text) if is_whole else float(text)
    except ValueError:
        return text
