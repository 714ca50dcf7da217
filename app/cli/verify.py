"""`hexapods verify`: repeat what is in a file, such as a benchmark's scores, and compare it.

The core repeats score files, and features repeat files of their own (`app.cli.verifier`).
"""

import argparse
import importlib
import json
from collections.abc import Iterable, Sequence
from typing import Any

from app.cli.commands import verifier_modules
from app.cli.files import read_bounded
from app.cli.options import CommandParser, integer
from app.cli.verifier import Verifier
from hexapods.domain.json_lists import check_lists

_DESCRIPTION = (
    "`hexapods verify`: repeat {things}, and compare each number to the last digit. The file is "
    "{origins}. The exit code is 0 if everything repeats, and 1 if something differs; each "
    "difference is a sentence. On another kind of processor, or by other versions, distances may "
    "differ in their last digits: where nothing else differs and all ranks hold, the exit code is "
    "0 too. See {docs}."
)
_MAX_BYTES = 48 << 20
"""Of a file; the largest have a few MB, and no more is read of them."""


def add_to(commands: "argparse._SubParsersAction[CommandParser]") -> None:
    """Add the command's parser."""
    verifiers = _verifiers()
    things = " or ".join(verifier.thing for verifier in verifiers)
    description = _DESCRIPTION.format(
        things=things,
        origins=", or ".join(verifier.origin for verifier in verifiers),
        docs=" and ".join(verifier.docs for verifier in verifiers),
    )
    parser = commands.add_parser("verify", help=f"repeat {things}", description=description)
    files = ", or ".join(verifier.file for verifier in verifiers)
    parser.add_argument("file", metavar="FILE", help=files)
    parser.add_argument(
        "--sample",
        type=integer,
        metavar="RUNS",
        help="of a benchmark, repeat only so many runs (default: all); scores are always computed "
        "again",
    )
    parser.add_argument(
        "--workers", type=integer, help="worker processes on this machine (default: one per core)"
    )
    parser.add_argument("--json", action="store_true", help="print standings and differences")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Repeat what is in a file, and print its result and what differs.

    Raises:
        HexapodError: if the file is of no kind that can be repeated, or damaged.
    """
    data = read_bounded(options.file, _MAX_BYTES)
    return _verifier_of(data, _verifiers()).verify(data, options)


def _verifiers() -> Sequence[Verifier]:
    """Return the verifiers of features, and last that of benchmarks."""
    modules = [*verifier_modules(), "app.cli.verify_benchmark"]
    return [importlib.import_module(module).VERIFIER for module in modules]


def _verifier_of(data: bytes, verifiers: Iterable[Verifier]) -> Verifier:
    """Return the verifier that recognizes a file, or else the first, which says what is wrong."""
    content: Any = None
    try:
        check_lists(data)
        content = json.loads(data)
    except (ValueError, RecursionError):
        pass
    first, *further = verifiers
    if isinstance(content, dict):
        return next((one for one in (first, *further) if one.recognizes(content)), first)
    return first
