"""`hexapods --version` answers before it imports what the commands need."""

import subprocess
import sys

from hexapods import __version__

_PROGRAM = """
import sys
from app.cli import main
code = main(["--version"])
imported = [name for name in ("numpy", "argparse", "app.settings") if name in sys.modules]
sys.exit(f"it imports {imported}" if imported else code)
"""


def test_the_version_is_printed_without_the_commands() -> None:
    done = subprocess.run(
        [sys.executable, "-c", _PROGRAM], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, f"hexapods {__version__}\n", "")
