"""The README's Python examples do what it says."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.running import ROOT

BLOCKS = re.findall(
    r"^```python\n(.*?)^```$", (ROOT / "README.md").read_text("utf-8"), re.MULTILINE | re.DOTALL
)


# `tests/test_wheel.py` runs the first, in an environment that has nothing else.
@pytest.mark.parametrize("block", BLOCKS[1:])
def test_each_block_of_python_runs(block: str, tmp_path: Path) -> None:
    subprocess.run([sys.executable, "-W", "error", "-c", block], check=True, cwd=tmp_path)


def test_there_are_others() -> None:
    assert len(BLOCKS) > 1
