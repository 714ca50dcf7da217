"""The tutorial's commands run as they stand, one after another in one folder."""

import re
import shlex
from pathlib import Path

import pytest

from tests.cli.running import ROOT, hexapods

_BLOCK = re.compile(r"^```(sh|python)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


@pytest.mark.timeout(300)
def test_every_command_of_the_tutorial_runs(tmp_path: Path) -> None:
    blocks = _BLOCK.findall((ROOT / "docs" / "tutorial.md").read_text("utf-8"))
    commands = [content for language, content in blocks if language == "sh"]
    assert len(commands) == 7
    for language, content in blocks:
        if language == "python":
            name = content.split("\n", 1)[0].removeprefix("# ")
            (tmp_path / name).write_text(content, "utf-8")
            continue
        for line in content.replace("\\\n", " ").splitlines():
            program, *arguments = shlex.split(line)
            assert program == "hexapods"
            done = hexapods(*arguments, folder=tmp_path)
            assert done.returncode == 0, (line, done.stderr)
    assert (tmp_path / "sweep" / "report.html").exists()
