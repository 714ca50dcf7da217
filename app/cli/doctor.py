"""`hexapods doctor`: check this machine and say what to do; changes nothing."""

import json
from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

from app.cli import machine_checks
from app.cli.options import AsJson, Data
from app.settings import read_settings
from hexapods.domain.errors import HexapodError


def doctor(*, data: Data = None, as_json: AsJson = False) -> int:
    """Check this machine and say what to do; the exit code is 1 if a check fails."""
    results = []
    for result in examine(data):
        results.append(result)
        if not as_json:
            print(f"{'✓' if result.ok else '✗'} {result.name}: {result.said}", flush=True)
    ok = all(result.ok for result in results)
    if as_json:
        print(json.dumps({"ok": ok, "checks": [result._asdict() for result in results]}))
    return 0 if ok else 1


class CheckResult(NamedTuple):
    """Result of one check; its fields are the members of the JSON output."""

    name: str
    ok: bool
    said: str


def examine(data: str | None) -> Iterator[CheckResult]:
    """Run the checks one after the other, and yield each result.

    With settings that are not valid those that need them are left out.

    Args:
        data: data folder, if other than that of the environment.
    """
    for name, check in machine_checks.CHECKS.items():
        yield _run_check(name, check)
    try:
        settings = read_settings(data=data)
    except HexapodError as error:
        yield CheckResult("settings", False, str(error))
        return
    # Imported here, as the database modules would slow the start of other commands.
    from app.cli.data_checks import CHECKS  # noqa: PLC0415

    for name, check_of in CHECKS.items():
        yield _run_check(name, partial(check_of, settings))


def _run_check(name: str, check: Callable[[], str]) -> CheckResult:
    try:
        return CheckResult(name, True, check())
    except (machine_checks.CheckFailed, HexapodError) as error:
        return CheckResult(name, False, str(error))
    except Exception as error:  # one broken check must not stop the others
        return CheckResult(
            name, False, f"{type(error).__name__}: {error}; {machine_checks.INSTALL}"
        )
