"""Imports are declared in pyproject.toml, and those of extras are under `needs`."""

import ast
import re
import sys
import tomllib
from collections.abc import Iterator
from functools import cache
from importlib.machinery import ModuleSpec
from importlib.metadata import packages_distributions
from pathlib import Path
from typing import NamedTuple

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from hexapods.domain.errors import InvalidInput
from hexapods.extras import MODULES, MissingExtra, install_command, is_installed, needs

CHECKOUT = Path(__file__).parents[1]
PROJECT = tomllib.loads((CHECKOUT / "pyproject.toml").read_text("utf-8"))["project"]
OF_EXAMPLES = {"dqn", "tuning"}
"""Extras that only docs/examples need, and the product does not import."""


class Import(NamedTuple):
    """An import of a module of another distribution."""

    path: Path
    line: int
    module: str
    extra: str | None
    """Of the `needs` around it; None without one."""

    def __str__(self) -> str:
        return f"{self.path.relative_to(CHECKOUT)}:{self.line} imports {self.module}"


def names(requirements: list[str]) -> set[str]:
    """Return the names of the distributions of some requirements."""
    return {canonicalize_name(Requirement(text).name) for text in requirements}


BASE = names(PROJECT["dependencies"])
EXTRAS = {extra: names(texts) for extra, texts in PROJECT["optional-dependencies"].items()}


@cache
def imports() -> tuple[Import, ...]:
    """Return all imports of the product from elsewhere, but those for types alone."""
    files = (path for root in ("app", "hexapods") for path in (CHECKOUT / root).rglob("*.py"))
    return tuple(
        each for path in files for each in imports_in(path, ast.parse(path.read_bytes()), None)
    )


def imports_in(path: Path, node: ast.AST, extra: str | None) -> Iterator[Import]:
    """Yield the imports below a node of a file."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.If) and ast.unparse(child.test) == "TYPE_CHECKING":
            continue
        if isinstance(child, ast.Import):
            modules = [alias.name for alias in child.names]
        else:
            modules = [child.module or ""] if isinstance(child, ast.ImportFrom) else []
        for module in modules:
            root = module.partition(".")[0]
            if root not in {"app", "hexapods", *sys.stdlib_module_names}:
                assert isinstance(child, ast.stmt)
                yield Import(path, child.lineno, root, extra)
        yield from imports_in(path, child, extra_of(child) or extra)


def extra_of(node: ast.AST) -> str | None:
    """Return the extra of `with needs(extra, …)`; None for any other node."""
    if isinstance(node, ast.With):
        match = re.match(r"needs\('(\w+)', ", ast.unparse(node.items[0]))
        return match[1] if match else None
    return None


def distributions_of(module: str) -> set[str]:
    """Return the distributions that have a module."""
    return {canonicalize_name(name) for name in _distributions().get(module, [module])}


_distributions = cache(packages_distributions)


def test_every_import_is_of_a_declared_dependency() -> None:
    wrong = [
        str(each)
        for each in imports()
        if not distributions_of(each.module) & (EXTRAS[each.extra] if each.extra else BASE)
    ]
    assert not wrong, "declare it in pyproject.toml, or import it under `needs` of its extra"


def test_nothing_is_declared_that_is_not_imported() -> None:
    imported = {name for each in imports() for name in distributions_of(each.module)}
    declared = BASE.union(*(EXTRAS[extra] for extra in EXTRAS.keys() - OF_EXAMPLES))
    assert declared - imported == set()


def test_the_modules_of_the_extras_are_those_that_are_imported() -> None:
    under_needs: dict[str, set[str]] = {}
    for each in imports():
        if each.extra is not None:
            under_needs.setdefault(each.extra, set()).add(each.module)
    assert under_needs == {extra: set(modules) for extra, modules in MODULES.items()}
    assert MODULES.keys() | OF_EXAMPLES == EXTRAS.keys()


@pytest.mark.parametrize("extra", MODULES)
def test_a_missing_module_is_reported_in_one_line_with_the_command_that_installs_it(
    extra: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    [module, *_] = MODULES[extra]
    monkeypatch.setitem(sys.modules, module, None)
    assert not is_installed(extra)
    with pytest.raises(MissingExtra) as raised, needs(extra, "a walk"):
        __import__(module)
    assert str(raised.value).startswith("a walk needs a package that is not installed here (")
    assert f"`{install_command(extra)}` installs it" in str(raised.value)
    assert "\n" not in str(raised.value)


def test_in_an_environment_with_pip_the_command_is_of_its_pip(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scripts = tmp_path / "checkout" / ".venv" / "bin"
    scripts.mkdir(parents=True)
    (scripts / "pip").touch(0o755)
    monkeypatch.setattr("importlib.util.find_spec", lambda name: ModuleSpec(name, None))
    monkeypatch.setattr("sysconfig.get_path", lambda name: str(scripts))
    command = 'pip install "racing-hexapods[gym,mcap]"'

    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.chdir(tmp_path / "checkout")
    assert install_command("gym", "mcap") == f".venv/bin/{command}"
    # No folder of a server is shown to whoever asks it.
    monkeypatch.setattr("sysconfig.get_path", lambda name: "/opt/hexapods/bin")
    assert install_command("gym", "mcap") == command
    monkeypatch.setattr("sysconfig.get_path", lambda name: str(scripts))
    monkeypatch.setenv("PATH", str(scripts))
    assert install_command("gym", "mcap") == command


@pytest.mark.parametrize(
    ("marks", "command"),
    [
        ((), 'uv pip install "racing-hexapods[gym,mcap]"'),
        (("tool/uv-receipt.toml",), 'uv tool install "racing-hexapods[gym,mcap]"'),
        (("CACHEDIR.TAG",), 'uvx --from "racing-hexapods[gym,mcap]" racing-hexapods'),
    ],
    ids=["environment", "tool", "cache"],
)
def test_in_an_environment_of_uv_the_command_is_of_uv(
    marks: tuple[str, ...], command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "tool").mkdir()
    for mark in marks:
        (tmp_path / mark).touch()
    monkeypatch.setattr(sys, "prefix", str(tmp_path / "tool"))
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert install_command("gym", "mcap") == command


def test_an_unknown_extra_is_refused_with_those_that_there_are() -> None:
    with pytest.raises(InvalidInput, match=r"no extra 'figure'; the extras are cluster, figures, "):
        install_command("gym", "figure")
