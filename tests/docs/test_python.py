"""The programs of the documentation: those of docs/python.md run, and all have correct types."""

import os
import re
import subprocess
import sys
from pathlib import Path

from tests.cli.running import ROOT
from tests.docs.programs import DOCS, blocks, programs


def test_the_examples_run(tmp_path: Path) -> None:
    examples = blocks(DOCS / "python.md")
    program, printed = tmp_path / "program.py", []
    # The page is opened in a browser that ends at once.
    variables = {"BROWSER": "true", "XDG_CACHE_HOME": str(tmp_path / "cache")}
    for example in examples:
        program.write_text(example, "utf-8")
        done = subprocess.run(
            [sys.executable, "-W", "error", program.name],
            cwd=tmp_path,
            env={**os.environ, **variables},
            capture_output=True,
            text=True,
            check=False,
        )
        assert (done.returncode, done.stderr) == (0, ""), example
        printed += done.stdout.splitlines()
    assert len(examples) == 8
    assert {"program.py", "race.npz", "sarsa.npz", "trials.csv"} <= {
        path.name for path in tmp_path.iterdir()
    }
    assert any(re.match(r"Q-learning, 50 steps, α 0\.1 0\.\d", line) for line in printed), printed


def test_the_settings_of_the_documented_agents_change_what_they_learn(tmp_path: Path) -> None:
    """Each declares a setting: another value gives another table, and so another walk."""
    [cautious] = [block for block in blocks(ROOT / "README.md") if "class Cautious" in block]
    [hurried] = [block for block in blocks(DOCS / "python.md") if "class Hurried" in block]
    (tmp_path / "cautious.py").write_text(cautious, "utf-8")
    (tmp_path / "hurried.py").write_text(hurried.partition("\n\n\nfor ")[0], "utf-8")
    program = """
import hexapods as hx

def learned(agent, **settings):
    training = hx.train(agent, steps=200, seed=1, simulator="kinematic", **settings)
    return training.q_table_sha256, training.distance_m

def differ(*trainings):
    tables, distances_m = zip(*trainings)
    return len(set(tables)), len(set(distances_m))

plain = learned("q-learning")
later = [{"step": 20, "settings": {"caution": 4.0}}]
for agent, off in (("cautious:Cautious", {"caution": 1.0}), ("hurried:Hurried", {"cost_m": 0.0})):
    print(differ(plain, learned(agent, **off)), differ(plain, learned(agent)))
print(differ(plain, learned("cautious:Cautious", caution=1.0, changes=later)))
"""
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", program],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout.splitlines() == ["(1, 1) (2, 2)", "(1, 1) (2, 2)", "(2, 2)"], done.stderr


def test_mypy_finds_nothing_in_any_program(tmp_path: Path) -> None:
    written = programs()
    for name, program in written.items():
        (tmp_path / name).write_text(program, "utf-8")
    checked = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", *(str(tmp_path / name) for name in written)],
        cwd=ROOT,  # its settings, and what it knows of the library already
        env={**os.environ, "MYPYPATH": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert checked.returncode == 0, checked.stdout
    assert {"readme_0.py", "python_0.py", "my_agent.py", "reproduce_notebook.py"} <= set(written)
