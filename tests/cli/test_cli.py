"""What all commands have in common: `app.cli.main`."""

import subprocess
from pathlib import Path

import pytest

from tests.cli.running import ROOT
from tests.forked import HEXAPODS


@pytest.mark.parametrize(("command", "read"), [("doctor", 0), ("doctor", 1), ("--help", 0)])
def test_command_whose_reader_has_gone_ends_without_a_word(
    command: str, read: int, tmp_path: Path
) -> None:
    """As of `hexapods doctor | head -1`."""
    process = subprocess.Popen(
        [*HEXAPODS, command],
        env={"PATH": "/usr/bin:/bin", "PYTHONPATH": str(ROOT)},
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    process.stdout.read(read)
    process.stdout.close()
    _, errors = process.communicate()
    assert (errors, process.returncode) == ("", 141)
