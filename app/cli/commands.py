"""The commands of `hexapods` by name: those of the core, and those that features add.

A feature names its commands in a module `app/features/NAME/commands.py`, and another package in a
module of its own, which an entry point of the group `hexapods.commands` gives with the feature's
name: `COMMANDS` has by command the module with its `add_to`. Neither imports anything else, since
`hexapods --version` and each command of the core would wait for it.
"""

import importlib
import os
import pkgutil
from collections.abc import Iterator, Mapping
from importlib.metadata import entry_points
from importlib.util import find_spec

from app.settings import read_without
from hexapods.domain.errors import InvalidInput

CORE_COMMANDS: Mapping[str, str] = {
    name: f"app.cli.{name.replace('-', '_')}"
    for name in (
        *("serve", "train", "race", "benchmark", "best-known", "runs", "verify", "doctor", "bench"),
    )
}
GROUP = "hexapods.commands"
"""Entry-point group of commands of features of other packages."""
_PACKAGE = "app.features"


def command_modules(
    name: str | None = None, environ: Mapping[str, str] = os.environ
) -> dict[str, str]:
    """Return the modules of all commands by name, or of one command alone.

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
    modules = dict(CORE_COMMANDS)
    for feature, commands in _commands_of_features():
        if feature in without:
            if name in commands:
                raise InvalidInput(
                    f"{name} is a command of the feature {feature}, which HEXAPODS_WITHOUT "
                    "leaves out"
                )
            continue
        if twice := sorted(commands.keys() & modules.keys()):
            raise InvalidInput(
                f"the feature {feature} has the command {twice[0]}, which is there already; leave "
                f"{feature} out by HEXAPODS_WITHOUT"
            )
        modules |= commands
    return modules if name is None or name not in modules else {name: modules[name]}


def _commands_of_features() -> Iterator[tuple[str, Mapping[str, str]]]:
    """Yield the names of features that have commands, with these; left-out features too."""
    package = importlib.import_module(_PACKAGE)
    for feature in sorted(module.name for module in pkgutil.iter_modules(package.__path__)):
        path = f"{_PACKAGE}.{feature}.commands"
        if find_spec(path) is not None:
            yield feature, importlib.import_module(path).COMMANDS
    for entry in entry_points(group=GROUP):
        try:
            yield entry.name, entry.load().COMMANDS
        except Exception as error:
            raise InvalidInput(
                f"the commands of the feature {entry.name} cannot be imported from {entry.value}: "
                f"{error}; mend or uninstall its package"
            ) from error
