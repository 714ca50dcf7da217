"""The lock files pin everything, fit pyproject.toml, and say nothing about who made them."""

import json
import re
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement

CHECKOUT = Path(__file__).parent.parent
RUN_LOCK = CHECKOUT / "requirements.lock"
DEV_LOCK = CHECKOUT / "requirements-dev.lock"
DQN_LOCK = CHECKOUT / "requirements-dqn.lock"
PAGE_LOCK = CHECKOUT / "package-lock.json"


def pinned_versions(lock: Path) -> dict[str, str]:
    return dict(re.findall(r"^([a-z0-9-]+)==([^ ]+) ", lock.read_text(), flags=re.MULTILINE))


@pytest.mark.parametrize("lock", [RUN_LOCK, DEV_LOCK, DQN_LOCK], ids=lambda lock: lock.name)
def test_every_package_is_pinned_by_hash_and_names_no_place(lock: Path) -> None:
    text = lock.read_text()

    assert "/" not in text  # neither an address nor a path
    packages = re.findall(r"^[^ #\n].*\n(.*)", text, flags=re.MULTILINE)
    assert len(packages) == len(pinned_versions(lock))
    assert all(line.startswith("    --hash=sha256:") for line in packages)


def test_the_locks_of_the_product_and_of_the_tests_agree() -> None:
    assert pinned_versions(RUN_LOCK).items() <= pinned_versions(DEV_LOCK).items()


def extras_of(lock: str) -> list[str]:
    """Return the extras that a lock has, by the Makefile's name of it."""
    texts = re.findall(
        rf"^({lock}_EXTRAS|RUN_EXTRAS) := (.*)$", (CHECKOUT / "Makefile").read_text(), re.MULTILINE
    )
    return [name for _, text in texts for name in text.split() if not name.startswith("$")]


@pytest.mark.parametrize(
    ("lock", "name", "groups"),
    [(RUN_LOCK, "RUN", ["build"]), (DEV_LOCK, "DEV", ["build", "dev"])],
    ids=["run", "dev"],
)
def test_the_lock_is_current(lock: Path, name: str, groups: list[str]) -> None:
    project = tomllib.loads((CHECKOUT / "pyproject.toml").read_text())
    wanted = [*project["project"]["dependencies"], *project["build-system"]["requires"]]
    for extra in extras_of(name):
        wanted += project["project"]["optional-dependencies"][extra]
    for group in groups:
        wanted += [item for item in project["dependency-groups"][group] if isinstance(item, str)]

    pinned = pinned_versions(lock)
    for requirement in map(Requirement, wanted):
        assert requirement.specifier.contains(pinned[requirement.name]), (
            f"run `make lock`: {wanted}"
        )


def test_the_checks_have_every_extra_but_that_of_the_deep_network() -> None:
    project = tomllib.loads((CHECKOUT / "pyproject.toml").read_text())["project"]
    assert {*extras_of("DEV")} == project["optional-dependencies"].keys() - {"dqn"}


def test_the_example_of_a_deep_network_changes_nothing_that_is_pinned_already() -> None:
    pinned, dev = pinned_versions(DQN_LOCK), pinned_versions(DEV_LOCK)

    assert {name: dev[name] for name in pinned.keys() & dev.keys()}.items() <= pinned.items()


def test_pytorch_is_pinned_by_the_makefile_alone_and_brings_no_cuda() -> None:
    extra = tomllib.loads((CHECKOUT / "pyproject.toml").read_text())["project"][
        "optional-dependencies"
    ]["dqn"]
    pinned = pinned_versions(DQN_LOCK)
    torch = re.search(r"^TORCH := torch==(.*)$", (CHECKOUT / "Makefile").read_text(), re.MULTILINE)

    assert not [name for name in pinned if re.match("torch|triton|nvidia|cuda", name)]
    assert torch
    for requirement in map(Requirement, extra):
        assert requirement.specifier.contains({**pinned, "torch": torch[1]}[requirement.name])


def test_the_tools_of_the_page_are_pinned_by_hash_and_name_no_place() -> None:
    text = PAGE_LOCK.read_text()
    root, *packages = json.loads(text)["packages"].values()

    assert "://" not in text
    assert packages
    assert all(package["integrity"].startswith("sha512-") for package in packages)
    assert (
        root["devDependencies"]
        == json.loads((CHECKOUT / "package.json").read_text())["devDependencies"]
    )
