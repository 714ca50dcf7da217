"""`python -m hexapods` is the command `hexapods`."""

import subprocess
import sys
from pathlib import Path

from hexapods import __version__

CHECKOUT = Path(__file__).parents[1]


def run(*options: str, folder: Path) -> tuple[int, str, str]:
    """Run the module in a folder; return exit code, output and errors."""
    command = [sys.executable, *options, "-m", "hexapods", "--version"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def test_it_runs_the_command_beside_a_package_named_app(tmp_path: Path) -> None:
    (tmp_path / "app.py").write_text("raise ImportError('somebody else’s')", "utf-8")

    assert run(folder=tmp_path) == (0, f"hexapods {__version__}\n", "")


def test_without_the_installed_package_it_says_how_to_install_it() -> None:
    code, _, said = run("-S", folder=CHECKOUT)  # which leaves out what is installed

    assert code == 2
    [line] = said.splitlines()
    assert "`pip install racing-hexapods`" in line
