"""Checks of `hexapods doctor` on the installed packages and the physics, without settings."""

import base64
import hashlib
import math
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from importlib.metadata import Distribution, PackageNotFoundError, distribution, version
from pathlib import Path

from hexapods.extras import MODULES, install_command, is_installed
from hexapods.version import __version__

_PYTHON = (3, 11)
_PHYSICS_TIMEOUT_S = 60.0
INSTALL = "install it again as the README says"
_NO_AVX = "it needs a processor with AVX, which some virtual machines hide"
_CODE = {".py", ".so", ".dll", ".dylib", ".pyd"}
_PIN = re.compile(r"([A-Za-z0-9-]+)==([\w.]+)$")


class CheckFailed(Exception):
    """A failed check; the message states the problem and its remedy."""


def _packages() -> str:
    """Check Python, and the packages of which results and formats depend on the exact version."""
    python_version = ".".join(map(str, sys.version_info[:3]))
    if sys.version_info < _PYTHON:
        raise CheckFailed(f"this is Python {python_version}; Racing Hexapods needs 3.11 or newer")
    try:
        requirements = distribution("racing-hexapods").requires or []
    except PackageNotFoundError as error:
        raise CheckFailed(f"Racing Hexapods is not installed as a package; {INSTALL}") from error
    pins = [match.groups() for match in map(_PIN.match, requirements) if match]
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
    installation = f"Python {python_version}, Racing Hexapods {__version__}, {versions}"
    missing = [extra for extra in MODULES if not is_installed(extra)]
    if not missing:
        return installation
    return f"{installation}; without {', '.join(missing)}: {install_command(*missing)}"


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


def _physics() -> str:
    return _run_apart("from app.cli.machine_checks import walk_in_mujoco; walk_in_mujoco()")


def _run_apart(program: str) -> str:
    """Return what a program prints in a process of its own; MuJoCo may end it (SIGILL, no AVX).

    Raises:
        CheckFailed: if it fails.
    """
    # Warnings would be repeated in the last line of an error.
    command = [sys.executable, "-W", "ignore", "-Pc", program]
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
    """Take ten steps and print the rate; an exception is reported as the check's failure.

    The engine itself is asked for its version: metadata does not say which of two packages that
    share their files was installed last.
    """
    # The other checks are to work without what may fail here.
    from hexapods.domain.observation import legal_actions, observe  # noqa: PLC0415
    from hexapods.physics.engine import mismatch  # noqa: PLC0415
    from hexapods.physics.mujoco_simulator import MujocoSimulator  # noqa: PLC0415
    from hexapods.runs.config import WalkingProblem  # noqa: PLC0415

    if wrong := mismatch():
        sys.exit(wrong)
    steps, walk = 10, WalkingProblem(gait="left-right-origin")
    simulator = MujocoSimulator(walk.robot, walk.resolved_gait, walk.grid)
    state, began = simulator.rest(), time.perf_counter()
    for number in range(steps):
        legal = legal_actions(observe(simulator, state, "measured"), len(walk.grid))
        state = simulator.step(state, legal[number % len(legal)]).state
    elapsed_s = time.perf_counter() - began
    if not all(map(math.isfinite, state.row)):
        raise ValueError("the physics returned non-finite values")
    print(
        f"the MuJoCo with which results repeat walks {steps / elapsed_s:,.0f} steps a second "
        "on one core"
    )


CHECKS: Mapping[str, Callable[[], str]] = {"packages": _packages, "physics": _physics}
