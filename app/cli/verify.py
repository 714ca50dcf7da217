"""`hexapods verify`: repeat what is in a file, such as a benchmark's scores, and compare it.

The core repeats score files, and features repeat files of their own (`app.cli.verifier`).
"""

import json
from collections.abc import Iterable, Sequence
from typing import Annotated, Any

from cyclopts import App, Parameter

from app.cli.commands import load, verifier_paths
from app.cli.files import read_bounded
from app.cli.verifier import Verifier, VerifyOptions
from hexapods.domain.json_lists import check_lists

_DESCRIPTION = (
    "Repeat {things}, and compare each number to the last digit.\n\nThe file is "
    "{origins}. The exit code is 0 if everything repeats, and 1 if something differs; each "
    "difference is a sentence. On another kind of processor, or by other versions, distances may "
    "differ in their last digits: where nothing else differs and all ranks hold, the exit code is "
    "0 too. See {docs}."
)
_MAX_BYTES = 48 << 20
"""Of a file; the largest have a few MB, and no more is read of them."""
_DEFAULTS = VerifyOptions()


def verify() -> App:
    """Return the command, whose description names what the installed verifiers repeat."""
    verifiers = _verifiers()
    description = _DESCRIPTION.format(
        things=" or ".join(verifier.thing for verifier in verifiers),
        origins=", or ".join(verifier.origin for verifier in verifiers),
        docs=" and ".join(verifier.docs for verifier in verifiers),
    )
    command = App(help=description)
    command.default(_verify)
    return command


def _verify(
    file: Annotated[str, Parameter(name="FILE", help="file to repeat")],
    /,
    options: VerifyOptions = _DEFAULTS,
) -> int:
    data = read_bounded(file, _MAX_BYTES)
    return _verifier_of(data, _verifiers()).verify(data, file, options)


def _verifiers() -> Sequence[Verifier]:
    """Return the verifiers of features, and last that of benchmarks."""
    return [load(path) for path in (*verifier_paths(), "app.cli.verify_benchmark:VERIFIER")]


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
        return next((entry for entry in (first, *further) if entry.recognizes(content)), first)
    return first
