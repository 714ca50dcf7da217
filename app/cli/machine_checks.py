"""Checks of `hexapods doctor` on the machine, the installation and the settings."""

import base64
import hashlib
import math
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from importlib.metadata import Distribution, PackageNotFoundError, distribution, version
from pathlib import Path

from app.setting_fields import PREFIX
from app.settings import Settings, is_loopback
from hexapods import __version__, assets

_PYTHON = (3, 11)
_PHYSICS_TIMEOUT_S = 60.0
INSTALL = "install it again as the README says"
_NO_AVX = "it needs a processor with AVX, which some virtual machines hide"
_ASSET = re.compile(r'"(?:\./)?static/([^"]+\.(?:js|css|svg))"')
_CODE = {".py", ".so", ".dll", ".dylib", ".pyd"}
_PIN = re.compile(r"([A-Za-z0-9-]+)==([\w.]+)$")


class CheckFailed(Exception):
    """A failed check; the message states the problem and its remedy."""


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
        raise CheckFailed(f"Racing Hexapods is not installed as a package; {INSTALL}") from error
    pins = [found.groups() for found in map(_PIN.match, requirements) if found]
    for name, pinned in pins:
        try:
            installed = version(name)
        except PackageNotFoundError as error:
            raise CheckFailed(f"{name} is missing; {INSTALL}") from error
        if installed != pinned:
            raise CheckFailed(f"{name} is {installed}, and has to be {pinned}; {INSTALL}")
    for name, _ in pins:
        if (changed := changed_file(distribution(name))) is not None:
            raise CheckFailed(
                f"{changed} is not the one of {name}: another package, or somebody, has changed "
                f"it; {INSTALL}"
            )
    versions = ", ".join(f"{name} {pinned}" for name, pinned in pins)
    return f"Racing Hexapods {__version__} with {versions}, as they have to be"


def changed_file(package: Distribution) -> str | None:
    """Return a module or library of an installed package that is not as it was installed.

    Packages can share files, as `mujoco` and `mujoco-core` do: the one installed last has its own.
    """
    for file in package.files or ():
        if file.hash is None or _CODE.isdisjoint(file.suffixes):
            continue
        try:
            with Path(file.locate()).open("rb") as opened:
                digest = hashlib.file_digest(opened, file.hash.mode).digest()
        except OSError:
            return str(file)
        if base64.urlsafe_b64encode(digest).rstrip(b"=").decode() != file.hash.value:
            return str(file)
    return None


def _engine() -> str:
    """Check what is loaded: metadata does not say what another package wrote over it."""
    program = "from hexapods.physics.engine import mismatch; print(mismatch() or '')"
    done = _run_apart(program, "-W", "ignore")
    if done.strip():
        raise CheckFailed(done.strip())
    return "the MuJoCo that is loaded is the one with which results repeat"


def _physics() -> str:
    return _run_apart("from app.cli.machine_checks import walk_in_mujoco; walk_in_mujoco()")


def _run_apart(program: str, *options: str) -> str:
    """Return what a program prints in a process of its own; MuJoCo may end it (SIGILL, no AVX).

    Raises:
        CheckFailed: if it fails.
    """
    command = [sys.executable, *options, "-Pc", program]
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
    raise CheckFailed(f"MuJoCo does not work: {last_line}; {INSTALL}")


def walk_in_mujoco() -> None:
    """Take ten steps and print the rate; an exception is reported as the check's failure."""
    # The other checks are to work without what may fail here.
    from hexapods.domain.observation import legal_actions, observe  # noqa: PLC0415
    from hexapods.physics.mujoco_simulator import MujocoSimulator  # noqa: PLC0415
    from hexapods.runs.config import WalkingProblem  # noqa: PLC0415

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
        raise CheckFailed(f"the page lacks {missing[0]}; {INSTALL}")
    from app.viewer.viewer_page import ViewerPage  # noqa: PLC0415 - takes a second

    ViewerPage()
    return "the dashboard is whole, and the viewer's page is the one that it was made for"


def _cores() -> str:
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    there = os.cpu_count() or 1
    return f"{usable} of {there} processor cores may be used; a job takes one each"


def check_settings(settings: Settings) -> str:
    """Check that only operators are operators, and say where the server would listen.

    Raises:
        CheckFailed: if anyone who reaches it is one.
    """
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
    if settings.public_url is not None and not settings.trusted_proxies:
        summary += (
            "; all clients of a proxy count as one address, unless it is named in "
            f"{PREFIX}TRUSTED_PROXIES"
        )
    return summary


CHECKS: Mapping[str, Callable[[], str]] = {
    "python": _python,
    "packages": _packages,
    "engine": _engine,
    "physics": _physics,
    "browser": _browser,
    "cores": _cores,
}
