"""`python -m hexapods`: the command `hexapods`, which is the dashboard's.

The library does not import the dashboard, so the command is looked up by its entry point.
"""

import sys
from importlib.metadata import EntryPoint, PackageNotFoundError, distribution
from pathlib import Path

from hexapods.domain.errors import HexapodError

_DISTRIBUTION, _COMMAND = "racing-hexapods", "hexapods"


class NoCommand(HexapodError):
    """The command is not installed; the message says how to install it."""


def main() -> int:
    """Run the command with the arguments of this process, and return its exit code."""
    _leave_working_folder()
    sys.argv[0] = _COMMAND
    try:
        entry_point = command()
    except NoCommand as error:
        sys.stderr.write(f"{_COMMAND}: {error}\n")
        return 2
    exit_code: int = entry_point.load()()
    return exit_code


def command() -> EntryPoint:
    """Return the entry point of the command.

    Raises:
        NoCommand: if the library is here without an installed package that has it.
    """
    try:
        scripts = distribution(_DISTRIBUTION).entry_points.select(group="console_scripts")
        return scripts[_COMMAND]
    except (PackageNotFoundError, KeyError) as error:
        raise NoCommand(
            f"the library is here, but not its command: install the package, by "
            f"`pip install {_DISTRIBUTION}`, or `pip install .` in a checkout"
        ) from error


def _leave_working_folder() -> None:
    """Take the working folder from the module path: another `app` may be in it.

    It stays if this package itself is from there.
    """
    folder = Path(__file__).parents[1]
    if not sys.flags.safe_path and folder != Path(sys.path[0]).resolve():
        del sys.path[0]


if __name__ == "__main__":
    sys.exit(main())
