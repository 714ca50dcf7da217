"""The examples of docs/python.md run, one after the other, each as a program of its own."""

import os
import re
import subprocess
import sys
from pathlib import Path

from tests.cli.running import ROOT

_BLOCK = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def test_the_examples_run(tmp_path: Path) -> None:
    blocks = _BLOCK.findall((ROOT / "docs" / "python.md").read_text("utf-8"))
    program, printed = tmp_path / "program.py", []
    # The page is opened in a browser that ends at once.
    variables = {"BROWSER": "true", "XDG_CACHE_HOME": str(tmp_path / "cache")}
    for number, block in enumerate(blocks):
        program.write_text("import hexapods as hx\n" * (number > 0) + block, "utf-8")
        done = subprocess.run(
            [sys.executable, "-W", "error", program.name],
            cwd=tmp_path,
            env={**os.environ, **variables},
            capture_output=True,
            text=True,
            check=False,
        )
        assert (done.returncode, done.stderr) == (0, ""), block
        printed += done.stdout.splitlines()
    assert len(blocks) == 6
    assert {"program.py", "race.npz", "sarsa.npz"} <= {path.name for path in tmp_path.iterdir()}
    assert any(re.match(r"Q-learning, 50\ssteps, α\s0\.1 0\.\d", line) for line in printed), printed
