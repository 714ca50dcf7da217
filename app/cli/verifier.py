"""A kind of file that `hexapods verify` repeats, of the core or of a feature."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any

from cyclopts import Parameter

from app.cli.options import AsJson, WholeNumber, Workers


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class VerifyOptions:
    """Options of `hexapods verify`, beside the file.

    Attributes:
        sample: of a benchmark, repeat only so many runs (default: all); scores are always computed
            again
        as_json: print standings and differences
    """

    sample: Annotated[WholeNumber | None, Parameter(metavar="RUNS")] = None
    workers: Workers = None
    as_json: AsJson = False


@dataclass(frozen=True, kw_only=True)
class Verifier:
    """Repeats files of one kind.

    Attributes:
        thing: what is repeated, such as `a benchmark`.
        file: its file, such as `score file`.
        origin: its file with where it is from, such as `the score file of hexapods benchmark`.
        docs: what tells of it, such as `docs/benchmark.md`.
        recognizes: whether the content of a file, an object of JSON, says that it is of this kind;
            it may be damaged.
        verify: repeats a file by its content, its path and the command's options, prints its
            result and what differs, and returns the exit code; raises a HexapodError if it cannot
            be read or repeated.
    """

    thing: str
    file: str
    origin: str
    docs: str
    recognizes: Callable[[Mapping[str, Any]], bool]
    verify: Callable[[bytes, str, VerifyOptions], int]
