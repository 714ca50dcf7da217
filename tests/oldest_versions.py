"""Run the library's and the API's tests with the oldest versions that pyproject.toml allows.

They are installed below build/oldest, with the oldest Python, and all else as the locks pin it: the
tools of the checks, and what those versions depend on where it fits. Anyone may have them, as pip
leaves in place what is new enough.
"""

import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator, Sequence

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from tests.digests import ROOT
from tests.other_pythons import find_pythons, version_of

_FOLDER = ROOT / "build" / "oldest"
_LOCK = ROOT / "requirements-dev.lock"
_EXAMPLES = "dqn"
"""Extra that has PyTorch, which no lock pins; `make promises` tries it."""
_TESTS = (["--tier=check"], ["--tier=check", "--tier=test", "tests/api", "tests/limits"])
"""Options of pytest, of which each is run by itself."""


def main() -> int:
    """Run the tests; return 0 if all pass."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    wanted = ".".join(re.findall(r"\d+", project["project"]["requires-python"]))
    pythons = {".".join(map(str, version_of(python)[:2])): python for python in find_pythons()}
    if wanted not in pythons:
        print(f"Python {wanted}, the oldest, is not here; there are {', '.join(pythons)}")
        return 1
    _FOLDER.mkdir(parents=True, exist_ok=True)
    names = _FOLDER / "names.txt"
    names.write_text("\n".join(requirements(project, _LOCK.read_text("utf-8"))) + "\n", "utf-8")
    environment, versions = _FOLDER / "environment", _FOLDER / "versions.txt"
    uv = (sys.executable, "-m", "uv", "--quiet")
    lowest = ("--resolution", "lowest-direct", "--python-version", wanted)
    _run([*uv, "pip", "compile", *lowest, str(names), "--output-file", str(versions)])
    _run([*uv, "venv", "--clear", "--python", pythons[wanted], str(environment)])
    python = environment / "bin" / "python"
    into = ("--python", str(python))
    _run([*uv, "pip", "install", *into, "--requirement", str(versions)])
    _run([*uv, "pip", "install", *into, "--no-deps", "--no-build-isolation", "--editable", "."])
    codes = [
        subprocess.run([python, "-m", "pytest", "-q", *options], cwd=ROOT, check=False).returncode
        for options in _TESTS
    ]
    return max(codes)


def requirements(project: dict[str, dict[str, object]], lock: str) -> Iterator[str]:
    """Yield the requirements of the product with its extras, and the tools as they are pinned.

    Args:
        project: content of pyproject.toml.
        lock: text of the lock of the tools.
    """
    pinned = dict(re.findall(r"^([a-z0-9-]+)==([^ ]+) ", lock, re.MULTILINE))
    about = project["project"]
    direct = [*_texts(about["dependencies"])]
    extras = about["optional-dependencies"]
    assert isinstance(extras, dict)
    for extra, texts in extras.items():
        if extra != _EXAMPLES:
            direct += _texts(texts)
    yield from direct
    names = {_name(text) for text in direct}
    for group in project["dependency-groups"].values():
        tools = {_name(text) for text in _texts(group)} - names
        yield from (f"{name}=={pinned[name]}" for name in sorted(tools))


def _texts(requirements: object) -> list[str]:
    assert isinstance(requirements, Sequence)
    return [text for text in requirements if isinstance(text, str)]


def _name(text: str) -> str:
    return canonicalize_name(Requirement(text).name)


def _run(command: list[str]) -> None:
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit((done.stderr.strip() or done.stdout.strip())[-1000:])


if __name__ == "__main__":
    sys.exit(main())
