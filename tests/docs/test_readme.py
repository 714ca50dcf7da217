"""The README's Python examples do what it says."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.running import ROOT
from tests.docs.programs import blocks

BLOCKS = blocks(ROOT / "README.md")


# `tests/test_wheel.py` runs the first, in an environment that has nothing else.
@pytest.mark.parametrize("block", BLOCKS[1:])
def test_each_block_of_python_runs(block: str, tmp_path: Path) -> None:
    subprocess.run([sys.executable, "-W", "error", "-c", block], check=True, cwd=tmp_path)


def test_the_readme_has_several_blocks() -> None:
    assert len(BLOCKS) > 1
