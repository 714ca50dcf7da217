"""The commands of `hexapods` by name: those of the core, and those that features add.

A feature names its commands in a module `app/features/NAME/commands.py`, and another package in a
module of its own, which an entry point of the group `hexapods.commands` gives with the feature's
name: `COMMANDS` has by command the path `module:function` of its function, whose signature
declares its options (`app.cli.program`). `VERBS`, if it is there, has by command of the core the
paths of functions that add verbs to its App; `VERIFIERS` has the paths of `Verifier`s, by which
`hexapods verify` repeats another kind of file. The module imports nothing else, since each command
of the core would wait for it.
"""

import importlib
import os
from collections.abc import Collection, Iterator, Mapping, Sequence
from types import ModuleType
from typing import Any, NamedTuple

from app.feature_modules import feature_modules
from app.settings import read_without
from hexapods.domain.errors import InvalidInput

CORE_COMMANDS: Mapping[str, str] = {
    name: f"app.cli.{name}:{name}"
    for name in (
        *("serve", "train", "race", "benchmark", "runs", "verify"),
        *("config", "doctor", "bench"),
    )
}
GROUP = "hexapods.commands"
"""Entry-point group of commands of features of other packages."""


def load(path: str) -> Any:
    """Import what a path names: `module:attribute`."""
    module, _, attribute = path.partition(":")
    return getattr(importlib.import_module(module), attribute)


def command_paths(
    name: str | None = None, environ: Mapping[str, str] = os.environ
) -> dict[str, str]:
    """Return the paths of all commands by name, or of one command alone.

    Importing those of all takes twice the time in which most commands start.

    Args:
        name: of a command; all are returned if there is none of this name.
        environ: environment, of which HEXAPODS_WITHOUT leaves features out.

    Raises:
        InvalidInput: if the command belongs to a feature that is left out, two features have a
            command of this name, or the commands of one cannot be imported.
    """
    if name is not None and name in CORE_COMMANDS:
        return {name: CORE_COMMANDS[name]}
    without = read_without(environ)
    paths = dict(CORE_COMMANDS)
    for feature, commands, *_ in _added(without):
        if feature in without:
            if name in commands:
                raise InvalidInput(
                    f"{name} is a command of the feature {feature}, which HEXAPODS_WITHOUT "
                    "leaves out"
                )
            continue
        if twice := sorted(commands.keys() & paths.keys()):
            raise InvalidInput(
                f"the feature {feature} has the command {twice[0]}, which is there already; leave "
                f"{feature} out by HEXAPODS_WITHOUT"
            )
        paths |= commands
    return paths if name is None or name not in paths else {name: paths[name]}


def verb_paths(command: str, environ: Mapping[str, str] = os.environ) -> list[str]:
    """Return the paths of the functions that add verbs of features to a command of the core.

    Args:
        command: the command.
        environ: environment, of which HEXAPODS_WITHOUT leaves features out.

    Raises:
        InvalidInput: if the commands of a feature cannot be imported.
    """
    without = read_without(environ)
    return [
        path
        for feature, _, verbs, _ in _added(without)
        if feature not in without
        for path in verbs.get(command, ())
    ]


def verifier_paths(environ: Mapping[str, str] = os.environ) -> list[str]:
    """Return the paths of the `Verifier`s of features.

    Args:
        environ: environment, of which HEXAPODS_WITHOUT leaves features out.

    Raises:
        InvalidInput: if the commands of a feature cannot be imported.
    """
    without = read_without(environ)
    return [
        path
        for added in _added(without)
        if added.feature not in without
        for path in added.verifiers
    ]


class _Added(NamedTuple):
    """What a feature adds: its name, and the paths of its commands, verbs and verifiers."""

    feature: str
    commands: Mapping[str, str]
    verbs: Mapping[str, Sequence[str]]
    verifiers: Sequence[str]

    @classmethod
    def by(cls, feature: str, module: ModuleType) -> "_Added":
        """Return what a feature names in a module."""
        verbs, verifiers = getattr(module, "VERBS", {}), getattr(module, "VERIFIERS", ())
        return cls(feature, module.COMMANDS, verbs, verifiers)


def _added(without: Collection[str]) -> Iterator[_Added]:
    """Yield what each feature adds that has commands; left-out features too."""
    for feature, _, module in feature_modules("commands", GROUP, without):
        yield _Added.by(feature, module)
