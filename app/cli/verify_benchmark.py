"""The part of `hexapods verify` that repeats score files of `hexapods benchmark`."""

import json

from app.cli.exit_codes import FAILED
from app.cli.terminal import progress
from app.cli.verifier import Verifier, VerifyOptions
from hexapods.benchmarking.score_file import HEAD, decode, row_of
from hexapods.benchmarking.verification import verification, version_note
from hexapods.domain.text import counted

_MAX_TOLD = 20


def _verify(data: bytes, file: str, options: VerifyOptions) -> int:
    content = decode(data, file)
    with progress("runs") as bar:
        task = bar.add_task("repeating", total=None)
        outcome = verification(
            content,
            options.workers,
            options.sample,
            lambda done, total: bar.update(task, completed=done, total=total),
        )
    note, differences = version_note(content), outcome.differences
    is_rounded = bool(differences) and outcome.is_rounding and note is not None
    repeats = not differences
    if options.as_json:
        shown = {
            "protocol": content["protocol"],
            "agent": content["agent"],
            "repeats": repeats,
            "is_rounding": is_rounded,
            "repeated_runs": outcome.repeated,
            "differences": differences,
            "version_note": note,
        }
        print(json.dumps(shown))
        return 0 if repeats or is_rounded else FAILED
    print(HEAD)
    print(row_of(content))
    for sentence in () if is_rounded else differences[:_MAX_TOLD]:
        print(sentence)
    if len(differences) > _MAX_TOLD and not is_rounded:
        print(f"{len(differences) - _MAX_TOLD:,} more differences.")
    if note is not None:
        print(note)
    count = counted(outcome.repeated, "run")
    if repeats:
        print(f"{file} repeats to the last digit: {count}, and all scores.")
    elif is_rounded:
        print(f"{file} repeats but for last digits: {count}, and all scores.")
    else:
        print(f"{file} does not repeat: see the differences above.")
    return 0 if repeats or is_rounded else FAILED


VERIFIER = Verifier(
    thing="a benchmark",
    file="score file",
    origin="the score file of `hexapods benchmark`",
    docs="docs/benchmark.md",
    recognizes=lambda content: "protocol" in content,
    verify=_verify,
)
