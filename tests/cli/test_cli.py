"""What all commands have in common: `app.cli.main`."""

import os
import pty
import re
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


def colours_of(folder: Path, **variables: str) -> set[str]:
    """Return the colour codes in what `--help` writes to a terminal."""
    terminal, program_end = pty.openpty()
    env = {"PATH": "/usr/bin:/bin", "PYTHONPATH": str(ROOT), "TERM": "xterm-256color", **variables}
    process = subprocess.Popen(
        [*HEXAPODS, "bench", "--help"], env=env, cwd=folder, stdout=program_end
    )
    os.close(program_end)
    written = b""
    try:
        while piece := os.read(terminal, 1 << 16):
            written += piece
    except OSError:  # how Linux tells that the other end has gone
        pass
    finally:
        os.close(terminal)
    assert process.wait() == 0
    assert b"hexapods bench" in written
    return set(re.findall(r"\x1b\[(?:1;)?[349][0-9;]+m", written.decode()))


def test_a_terminal_gets_colours_unless_the_user_wants_none(tmp_path: Path) -> None:
    assert colours_of(tmp_path)
    assert colours_of(tmp_path, NO_COLOR="1") == set()
