"""Run tests/test_reproducible.py in every other Python that is on this machine.

Each gets an environment of its own below build/pythons, of what the locks pin; it is kept until
they change. Where there is no other Python, or one that the locks cannot be installed for, that is
said, since nothing was compared.
"""

import hashlib
import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from tests.digests import ROOT

CHECKED = (3, 14)
"""The newest Python for which the locks have to install."""
_ENVIRONMENTS = ROOT / "build" / "pythons"
_TOOLS = ("iniconfig", "pytest", "pytest-timeout")


class NotInstalled(Exception):
    """An environment cannot be made; the message is the installer's."""


def main() -> int:
    """Compare; return 0 if all that can be compared is the same, else 1."""
    own_version = sys.version_info[:2]
    pythons = {version_of(python)[:2]: python for python in find_pythons()}
    other_pythons = {
        version: python for version, python in pythons.items() if version != own_version
    }
    if not other_pythons:
        print(
            f"Python {_name(own_version)} alone is here: its results were compared with no other's"
        )
        return 0
    is_same = True
    for version, python in other_pythons.items():
        try:
            environment = environment_of(version, python)
        except NotInstalled as error:
            print(f"Python {_name(version)} was not compared, as the locks do not install: {error}")
            is_same = is_same and version > CHECKED
            continue
        is_same = _passes(environment, version) and is_same
    return 0 if is_same else 1


def find_pythons() -> list[str]:
    """Return a command of each Python here that can make an environment, as `make` finds them."""
    command = ["sh", str(ROOT / ".ci" / "find-python"), "--all"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return done.stdout.splitlines()


def version_of(python: str) -> tuple[int, ...]:
    """Return the version of a Python."""
    program = "import sys; print(*sys.version_info[:3])"
    done = subprocess.run([python, "-c", program], capture_output=True, text=True, check=True)
    return tuple(map(int, done.stdout.split()))


def environment_of(version: Sequence[int], python: str) -> Path:
    """Return the Python of an environment with what the locks pin; make it if it is not there.

    Raises:
        NotInstalled: if it cannot be made.
    """
    folder = _ENVIRONMENTS / _name(version)
    inside = folder / "bin" / "python"
    dev_lock = (ROOT / "requirements-dev.lock").read_text()
    tools = "".join(
        re.findall(rf"^(?:{'|'.join(_TOOLS)})==(?:.*\\\n)*.*\n", dev_lock, re.MULTILINE)
    )
    wanted = hashlib.sha256((ROOT / "requirements.lock").read_bytes() + tools.encode()).hexdigest()
    stamp = folder / "installed"
    if stamp.is_file() and stamp.read_text() == wanted:
        return inside
    _run([python, "-m", "venv", "--clear", str(folder)])
    (folder / "tools.lock").write_text(tools)
    locks = ["--requirement", "requirements.lock", "--requirement", str(folder / "tools.lock")]
    options = ["install", "--quiet", "--require-hashes", *locks]
    pip = [str(inside), "-m", "pip"]
    configured = subprocess.run(
        [*pip, "config", "list"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    # As in the Makefile: uv takes a fifth of pip's time, but reads none of its configuration.
    try:
        if re.search(r"\.(index-url|no-index)=", configured.stdout):
            raise NotInstalled
        _run([sys.executable, "-m", "uv", "pip", *options, "--python", str(inside)])
    except NotInstalled:
        _run([*pip, *options, "--disable-pip-version-check", "--only-binary", ":all:"])
    stamp.write_text(wanted)
    return inside


def _passes(environment: Path, version: Sequence[int]) -> bool:
    """Run the tests in an environment, and print how they ended."""
    # The fixtures of all tests need browsers and databases.
    options = ["-q", "--noconftest", "-p", "no:cacheprovider", "tests/test_reproducible.py"]
    command = [str(environment), "-m", "pytest", *options]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode:
        print(done.stdout)
    closing = (done.stdout.strip() or done.stderr.strip()).splitlines()[-1]
    print(f"Python {_name(version)}: tests/test_reproducible.py: {closing}", flush=True)
    return done.returncode == 0


def _run(command: list[str]) -> None:
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode:
        raise NotInstalled((done.stderr.strip() or done.stdout.strip())[-500:])


def _name(version: Sequence[int]) -> str:
    return ".".join(map(str, version[:2]))


if __name__ == "__main__":
    sys.exit(main())
