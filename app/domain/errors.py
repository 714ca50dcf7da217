"""The one tree of errors. Each message is a sentence for the user that names what is valid."""

from collections.abc import Iterable


class HexapodError(Exception):
    """Anything that this product refuses or fails at, in one sentence."""


class InvalidInput(HexapodError):
    """The user asked for something that cannot be; the message says what can."""


class UnknownName(InvalidInput):
    """A name that is not registered, of a gait, an agent, a robot, a field and so on."""

    def __init__(self, kind: str, name: object, valid: Iterable[str]) -> None:
        super().__init__(f"unknown {kind} {name!r}; choose one of: {', '.join(valid)}")


class Unreachable(InvalidInput):
    """A leg of this robot cannot put its foot where the foot grid wants it."""


class TableMismatch(InvalidInput):
    """A Q-table that was learned for another problem than the one it is asked to solve."""


class DamagedFile(InvalidInput):
    """A file that is not what it claims to be, or not whole."""


class IllegalAction(HexapodError):
    """An agent chose what cannot be done where it is."""


class Diverged(HexapodError):
    """The physics left the finite numbers; whatever it computed since is meaningless."""
