"""The Dockerfile, by what it says: where this runs there need be no Docker."""

import re
from importlib.metadata import distribution
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parent.parent
DOCKERFILE = (ROOT / "Dockerfile").read_text("utf-8")
RUNTIME = DOCKERFILE.rpartition("\nFROM ")[2]


def needed_by(*names: str, extras: frozenset[str] = frozenset()) -> set[str]:
    """Return packages with all that they depend on here.

    Args:
        names: of installed packages.
        extras: of the first one, whose dependencies count.
    """
    needed: set[str] = set()
    todo = [(name, extras if name == names[0] else frozenset[str]()) for name in names]
    while todo:
        name, wanted = todo.pop()
        if canonicalize_name(name) in needed:
            continue
        needed.add(canonicalize_name(name))
        for line in distribution(name).requires or ():
            requirement = Requirement(line)
            markers = [{"extra": extra} for extra in (*wanted, "")]
            if requirement.marker is None or any(map(requirement.marker.evaluate, markers)):
                todo.append((requirement.name, frozenset(requirement.extras)))
    return needed


def test_what_the_build_alone_needs_is_not_in_the_image() -> None:
    makefile = (ROOT / "Makefile").read_text("utf-8")
    [extras] = re.findall(r"^RUN_EXTRAS := (.*)$", makefile, re.MULTILINE)
    running = needed_by("racing-hexapods", extras=frozenset(extras.split()))
    [removed] = re.findall(r"uninstall --yes (hatchling.*)$", DOCKERFILE, re.MULTILINE)
    assert {*removed.split()} == needed_by("hatchling") - running


def test_no_installer_is_in_the_image() -> None:
    assert "venv --without-pip /venv" in DOCKERFILE
    assert "python -m pip uninstall --yes pip" in RUNTIME
    # Python of this version brings neither of them, but a copy of pip.
    assert "ensurepip" in RUNTIME
    assert not re.search(r"setuptools|\bwheel\b", DOCKERFILE)


def test_both_stages_are_of_the_same_image() -> None:
    [build, runtime] = re.findall(r"^FROM (\S+)", DOCKERFILE, re.MULTILINE)
    assert build == runtime
    [minor] = re.findall(r"^python:(3\.\d+)-slim", build)
    assert f"/usr/local/lib/python{minor}/ensurepip" in RUNTIME


def test_the_image_says_what_it_is() -> None:
    labels = dict(re.findall(r'org\.opencontainers\.image\.(\w+)="([^"]+)"', RUNTIME))
    assert labels.keys() == {"title", "description", "licenses"}
    assert labels["licenses"] == distribution("racing-hexapods").metadata["License-Expression"]
    workflow = (ROOT / ".github/workflows/release.yml").read_text("utf-8")
    for label in ("version", "revision", "source", "created"):
        assert f"org.opencontainers.image.{label}=" in workflow
