"""Commands of the README and the documentation are ones that the command line takes.

Those of the tutorial also run (`test_tutorial.py`); the others may take hours, or need a cluster.
"""

import re
import shlex

import pytest

from app.cli.program import program_of
from tests.cli.running import ROOT

_PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
_BLOCK = re.compile(r"^```(?:sh|console)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def commands() -> list[str]:
    """Return every command that begins with `hexapods`, continued lines joined."""
    documented = []
    for page in _PAGES:
        for block in _BLOCK.findall(page.read_text("utf-8")):
            lines = block.replace("\\\n", " ").splitlines()
            documented += [line for line in lines if line.startswith("hexapods ")]
    return documented


def test_the_documents_have_commands() -> None:
    assert len(commands()) > 40


@pytest.mark.parametrize("command", commands())
def test_a_documented_command_is_valid(command: str) -> None:
    # What follows is of the shell: other commands, and a variable of the page.
    hexapods_command = re.split(r" [|>] ", command.replace("$agents", "q-learning"))[0]
    words = shlex.split(hexapods_command, comments=True)[1:]
    program = program_of(words)
    function, bound, _ = program.parse_args(words, print_error=False, exit_on_error=False)
    assert program.parse_commands(words)[0][0] == words[0]
    assert bound.arguments or function != program.help_print
