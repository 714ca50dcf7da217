"""Exception hierarchy. Each message is a sentence for the user that names the valid choices."""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from difflib import get_close_matches
from typing import Any


class HexapodError(Exception):
    """Base class of all errors that are reported to the user, as one sentence."""

    def __reduce__(self) -> tuple[Any, ...]:
        # By default an error is pickled as a call with its message alone. A pool of processes would
        # break on an error whose constructor takes other arguments.
        return _restored, (type(self), self.args, self.__dict__)


def _restored(
    kind: type[HexapodError], args: tuple[Any, ...], attributes: Mapping[str, Any]
) -> HexapodError:
    error = kind.__new__(kind)
    error.args = args
    error.__dict__.update(attributes)
    return error


class InvalidInput(HexapodError, ValueError):
    """The user's input is invalid; the message names the valid choices. Also a `ValueError`.

    Attributes:
        field: name of the invalid field; "" if it is unknown, or several do not fit together.
    """

    def __init__(self, message: str = "", *, field: str = "") -> None:
        super().__init__(message)
        self.field = field


@contextmanager
def about(field: str) -> Iterator[None]:
    """Set the `field` of an `InvalidInput` raised in the block, unless it has one."""
    try:
        yield
    except InvalidInput as error:
        error.field = error.field or field
        raise


class UnknownName(InvalidInput):
    """A name that is not registered: of a gait, an agent, a robot, a field and so on.

    The message lists the valid names, and suggests the one that is spelled most like it.
    """

    def __init__(self, kind: str, name: object, valid: Iterable[str]) -> None:
        names = list(valid)
        suggestion = "".join(
            f"; did you mean {similar}?" for similar in get_close_matches(str(name), names, n=1)
        )
        super().__init__(f"unknown {kind} {name!r}; choose one of: {', '.join(names)}{suggestion}")


class ImpossibleLegs(InvalidInput):
    """The legs of a robot are geometrically impossible.

    Attributes:
        legs: their numbers, from 1.
    """

    def __init__(self, message: str, legs: Iterable[int]) -> None:
        super().__init__(message)
        self.legs = tuple(legs)


class Unreachable(ImpossibleLegs):
    """A cell of the foot grid is out of reach of a leg of this robot."""


class TableMismatch(InvalidInput):
    """A Q-table was learned for another walking problem than the one it is used for."""


class DamagedFile(InvalidInput):
    """A file is truncated, or its content is not of the expected format."""


class OtherFormat(DamagedFile):
    """A file is of an earlier or later version of its format than the one that is read."""


class IllegalAction(HexapodError):
    """An agent chose an action that is illegal in the current state."""


class TooLong(HexapodError):
    """A run is too long for a type of file."""


class BudgetExceeded(HexapodError):
    """A search simulates more transitions than it may."""


class Diverged(HexapodError):
    """The physics simulation diverged to non-finite numbers."""
