"""`hexapods doctor`: check this machine and say what to do; changes nothing."""

import argparse
import json
import math
import os
import re
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from importlib.metadata import PackageNotFoundError, distribution, version
from typing import NamedTuple

from app import __version__, assets
from app.cli.options import CommandParser
from app.cli.stored_runs import add_data
from app.domain.errors import HexapodError
from app.settings import PREFIX, Settings, is_loopback, read_settings


def add_to(commands: "argparse._SubParsersAction[CommandParser]") -> None:
    """Add the command's parser."""
    parser = commands.add_parser("doctor", help="check this machine", description=__doc__)
    add_data(parser)
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run all checks; return 0 if all pass, else 1."""
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
_PHYSICS_TIMEOUT_S = 60.0
_INSTALL = "install it again as the README says"
_NO_AVX = "it needs a processor with AVX, which some virtual machines hide"
_ASSET = re.compile(r'"(?:\./)?static/([^"]+\.(?:js|css|svg))"')
_PIN = re.compile(r"([A-Za-z0-9-]+)==([\w.]+)$")


class CheckFailed(Exception):
    """A failed check; the message states the problem and its remedy."""


class CheckResult(NamedTuple):
    """Result of one check; its fields are the members of the JSON output."""

    name: str
    ok: bool
    said: str


def examine(data: str | None) -> Iterator[CheckResult]:
    """Run the checks one after the other, and yield each result.

    Args:
        data: data folder, if other than that of the environment.
    """
    for name, check in _MACHINE_CHECKS.items():
        yield _run_check(name, check)
    settings: list[Settings] = []

    def read() -> str:
        settings.append(read_settings(data=data))
        return _settings(settings[0])

    yield _run_check("settings", read)
    # Imported here, as the database modules would slow the start of other commands.
    from app.cli.data_diagnostics import CHECKS  # noqa: PLC0415

    for name, check_data in CHECKS.items() if settings else ():
        yield _run_check(name, lambda check_data=check_data: check_data(settings[0]))  # type: ignore[misc]


def _run_check(name: str, check: Callable[[], str]) -> CheckResult:
    try:
        return CheckResult(name, True, check())
    except (CheckFailed, HexapodError) as error:
        return CheckResult(name, False, str(error))
    except Exception as error:  # one broken check must not stop the others
        return CheckResult(name, False, f"{type(error).__name__}: {error}; {_INSTALL}")


def _python() -> str:
    python_version = ".".join(map(str, sys.version_info[:3]))
    if sys.version_info < _PYTHON:
        raise CheckFailed(f"this is Python {python_version}; Racing Hexapods needs 3.11 or newer")
    return f"Python {python_version} on {sys.platform}"


def _packages() -> str:
    """Check the exactly pinned packages: results and file formats depend on their versions."""
    try:
        requirements = distribution("racing-hexapods").requires or []
    except PackageNotFoundError as error:
        raise CheckFailed(f"Racing Hexapods is not installed as a package; {_INSTALL}") from error
    pins = [found.groups() for found in map(_PIN.match, requirements) if found]
    for name, pinned in pins:
        try:
            installed = version(name)
        except PackageNotFoundError as error:
            raise CheckFailed(f"{name} is missing; {_INSTALL}") from error
        if installed != pinned:
            raise CheckFailed(f"{name} is {installed}, and has to be {pinned}; {_INSTALL}")
    versions = ", ".join(f"{name} {pinned}" for name, pinned in pins)
    return f"Racing Hexapods {__version__} with {versions}, as they have to be"


def _physics() -> str:
    # In a process of its own, as MuJoCo dies of SIGILL on a processor without AVX.
    command = [sys.executable, "-Pc", "from app.cli.doctor import walk_in_mujoco; walk_in_mujoco()"]
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=_PHYSICS_TIMEOUT_S, check=False
        )
    except subprocess.TimeoutExpired as error:
        raise CheckFailed(
            f"ten steps took over {_PHYSICS_TIMEOUT_S:.0f} s; is the machine overloaded?"
        ) from error
    if done.returncode == 0:
        return done.stdout.strip()
    if done.returncode < 0:
        ended_by = signal.Signals(-done.returncode)
        why = f"; {_NO_AVX}" if ended_by == signal.SIGILL else ""
        raise CheckFailed(f"MuJoCo was ended by {ended_by.name}{why}")
    last_line = (done.stderr.strip().splitlines() or ["it said nothing"])[-1]
    raise CheckFailed(f"MuJoCo does not work: {last_line}; {_INSTALL}")


def walk_in_mujoco() -> None:
    """Take ten steps and print the rate; an exception is reported as the check's failure."""
    # The other checks are to work without what may fail here.
    from app.domain.observation import legal_actions, observe  # noqa: PLC0415
    from app.physics.mujoco_simulator import MujocoSimulator  # noqa: PLC0415
    from app.runs.config import WalkingProblem  # noqa: PLC0415

    steps, walk = 10, WalkingProblem(gait="left-right-origin")
    simulator = MujocoSimulator(walk.robot, walk.resolved_gait, walk.grid)
    state, began = simulator.rest(), time.perf_counter()
    for number in range(steps):
        legal = legal_actions(observe(simulator, state, "measured"), len(walk.grid))
        state = simulator.step(state, legal[number % len(legal)]).state
    elapsed_s = time.perf_counter() - began
    if not all(map(math.isfinite, state.row)):
        raise ValueError("the physics returned non-finite values")
    print(f"MuJoCo walks {steps / elapsed_s:,.0f} steps a second on one core")


def _browser() -> str:
    folder = assets.static_dir()
    wanted = _ASSET.findall((folder / "index.html").read_text("utf-8"))
    missing = [name for name in wanted if not (folder / name).is_file()]
    if missing:
        raise CheckFailed(f"the page lacks {missing[0]}; {_INSTALL}")
    from app.viewer.viser_internals.client import ViewerPage  # noqa: PLC0415 - takes a second

    ViewerPage()
    return "the dashboard is whole, and the viewer's page is the one that it was made for"


def _cores() -> str:
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    there = os.cpu_count() or 1
    return f"{usable} of {there} processor cores may be used; a job takes one each"


def _settings(settings: Settings) -> str:
    access = "every user of this machine is an operator"
    if settings.token is not None:
        access = "changes need the token"
        access += ", and so does watching" if settings.spectators == "token" else ""
    summary = f"it would listen on {settings.host}, and {access}"
    if settings.public_url is not None and settings.token is None:
        raise CheckFailed(
            f"{PREFIX}PUBLIC_URL offers the server at {settings.public_url}, and without a token "
            f"anyone who reaches it is an operator; set {PREFIX}TOKEN"
        )
    if not is_loopback(settings.host) and settings.public_url is None:
        summary += f"; a proxy before it needs {PREFIX}PUBLIC_URL"
    return summary


def can_listen(settings: Settings) -> bool:
    """Whether the address belongs to this machine and is free."""
    try:
        candidates = socket.getaddrinfo(settings.host, settings.port, type=socket.SOCK_STREAM)
        family, kind, protocol, _, address = candidates[0]
        with socket.socket(family, kind, protocol) as probe:
            if sys.platform != "win32":
                probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind(address)
            probe.listen(1)
    except OSError:
        return False
    return True


_MACHINE_CHECKS: dict[str, Callable[[], str]] = {
    "python": _python,
    "packages": _packages,
    "physics": _physics,
    "browser": _browser,
    "cores": _cores,
}
