"""`hexapods doctor`: looks at this machine and says what to do; changes nothing."""

import argparse
import json
import os
import re
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from importlib.metadata import PackageNotFoundError, distribution, version
from typing import NamedTuple

from app import __version__, assets
from app.cli.options import CommandParser
from app.cli.runs import add_data
from app.domain.errors import HexapodError
from app.settings import PREFIX, Settings, is_loopback, read_settings


def add_to(commands: "argparse._SubParsersAction[CommandParser]") -> None:
    """Describe the command."""
    parser = commands.add_parser("doctor", help="check this machine", description=__doc__)
    add_data(parser)
    parser.add_argument("--json", action="store_true", help="for programs")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Check everything; 0 if all is well, else 1."""
    findings = []
    for finding in examine(options.data):
        findings.append(finding)
        if not options.json:
            print(f"{'✓' if finding.ok else '✗'} {finding.name}: {finding.said}", flush=True)
    ok = all(finding.ok for finding in findings)
    if options.json:
        print(json.dumps({"ok": ok, "checks": [finding._asdict() for finding in findings]}))
    return 0 if ok else 1


_PYTHON = (3, 11)
_PHYSICS_WITHIN_S = 60.0
_INSTALL = "install it again as the README says"
_NO_AVX = "it needs a processor with AVX, which some virtual machines hide"
_ASSET = re.compile(r'"(?:\./)?static/([^"]+\.(?:js|css|svg))"')
_PIN = re.compile(r"([A-Za-z0-9-]+)==([\w.]+)$")


class Trouble(Exception):
    """Something is not as it has to be; the message says what, and what to do."""


class Finding(NamedTuple):
    """Result of one check."""

    name: str
    ok: bool
    said: str


def examine(data: str | None) -> Iterator[Finding]:
    """One check after the other.

    Args:
        data: the data folder, if another than the environment's.
    """
    for name, check in _OF_THE_MACHINE.items():
        yield _found(name, check)
    settings: list[Settings] = []

    def read() -> str:
        settings.append(read_settings(data=data))
        return _settings(settings[0])

    yield _found("settings", read)
    # Imports the database, which takes a moment.
    from app.cli.data_diagnostics import CHECKS  # noqa: PLC0415

    for name, look in CHECKS.items() if settings else ():
        yield _found(name, lambda look=look: look(settings[0]))  # type: ignore[misc]


def _found(name: str, check: Callable[[], str]) -> Finding:
    try:
        return Finding(name, True, check())
    except (Trouble, HexapodError) as error:
        return Finding(name, False, str(error))
    except Exception as error:  # whatever is broken here, a doctor goes on
        return Finding(name, False, f"{type(error).__name__}: {error}; {_INSTALL}")


def _python() -> str:
    found = ".".join(map(str, sys.version_info[:3]))
    if sys.version_info < _PYTHON:
        raise Trouble(f"this is Python {found}; Racing Hexapods needs 3.11 or newer")
    return f"Python {found} on {sys.platform}"


def _packages() -> str:
    """The versions that are exact are those whose formats and results are relied on."""
    try:
        wanted = distribution("racing-hexapods").requires or []
    except PackageNotFoundError as error:
        raise Trouble(f"Racing Hexapods is not installed as a package; {_INSTALL}") from error
    pins = [found.groups() for found in map(_PIN.match, wanted) if found]
    for name, pinned in pins:
        try:
            here = version(name)
        except PackageNotFoundError as error:
            raise Trouble(f"{name} is missing; {_INSTALL}") from error
        if here != pinned:
            raise Trouble(f"{name} is {here}, and has to be {pinned}; {_INSTALL}")
    said = ", ".join(f"{name} {pinned}" for name, pinned in pins)
    return f"Racing Hexapods {__version__} with {said}, as they have to be"


def _physics() -> str:
    # In a process of its own, because a processor that MuJoCo was not made for ends it at once.
    command = [sys.executable, "-m", "app.cli.physics_diagnostics"]
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=_PHYSICS_WITHIN_S, check=False
        )
    except subprocess.TimeoutExpired as error:
        raise Trouble(
            f"ten steps took over {_PHYSICS_WITHIN_S:.0f} s; is the machine overloaded?"
        ) from error
    if done.returncode == 0:
        return done.stdout.strip()
    if done.returncode < 0:
        ended_by = signal.Signals(-done.returncode)
        why = f"; {_NO_AVX}" if ended_by == signal.SIGILL else ""
        raise Trouble(f"MuJoCo was ended by {ended_by.name}{why}")
    said = (done.stderr.strip().splitlines() or ["it said nothing"])[-1]
    raise Trouble(f"MuJoCo does not work: {said}; {_INSTALL}")


def _browser() -> str:
    folder = assets.static_dir()
    wanted = _ASSET.findall((folder / "index.html").read_text("utf-8"))
    missing = [name for name in wanted if not (folder / name).is_file()]
    if missing:
        raise Trouble(f"the page lacks {missing[0]}; {_INSTALL}")
    from app.viewer.viser_internals.client import ViewerPage  # noqa: PLC0415 - takes a second

    ViewerPage()
    return "the dashboard is whole, and the viewer's page is the one that it was made for"


def _cores() -> str:
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    there = os.cpu_count() or 1
    return f"{usable} of {there} processor cores may be used; a job takes one each"


def _settings(settings: Settings) -> str:
    who = "whoever is on this machine may change everything"
    if settings.token is not None:
        who = "changes need the token"
        who += ", and so does watching" if settings.spectators == "token" else ""
    said = f"it would listen on {settings.host}, and {who}"
    if settings.public_url is not None and settings.token is None:
        raise Trouble(
            f"{PREFIX}PUBLIC_URL offers the server at {settings.public_url}, and without a token "
            f"everyone there may change everything; set {PREFIX}TOKEN"
        )
    if not is_loopback(settings.host) and settings.public_url is None:
        said += f"; a proxy before it needs {PREFIX}PUBLIC_URL"
    return said


def can_listen(settings: Settings) -> bool:
    """Whether the address is this machine's, and free."""
    try:
        found = socket.getaddrinfo(settings.host, settings.port, type=socket.SOCK_STREAM)
        family, kind, protocol, _, address = found[0]
        with socket.socket(family, kind, protocol) as probe:
            if sys.platform != "win32":
                probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind(address)
            probe.listen(1)
    except OSError:
        return False
    return True


_OF_THE_MACHINE: dict[str, Callable[[], str]] = {
    "python": _python,
    "packages": _packages,
    "physics": _physics,
    "browser": _browser,
    "cores": _cores,
}
