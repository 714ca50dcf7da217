"""Programs and files of the how-tos do what these say."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from app.features.classroom.lesson_file import read_file
from tests.cli.running import EXAMPLES, ROOT, in_process, output
from tests.docs.programs import DOCS, blocks
from tests.storage.ended_runs import ended_race, ended_training
from tests.storage.stores import opened

LOGGERS = {
    "tensorboardX": """
class SummaryWriter:
    def __init__(self, folder):
        pass

    def add_scalar(self, name, value, step):
        print(name, f"{value:.3f}", step)

    def close(self):
        print("closed")
""",
    "wandb": """
class Run:
    summary = {}

    def log(self, values, step):
        print(*(f"{name}={value:.3f}" for name, value in values.items()), step)

    def finish(self):
        print(self.summary)


def init(project, config):
    print(project, config)
    return Run()
""",
}
"""Stand-ins for packages that the checks do not have: they print what they are given."""


def printed(program: str, folder: Path) -> list[str]:
    """Run a program in a folder, and return the lines that it prints."""
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", program],
        cwd=folder,
        env={"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


def fenced(page: str, language: str) -> list[str]:
    """Return the blocks of a page in a language."""
    text = (DOCS / f"{page}.md").read_text("utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def test_loggers_get_each_record(tmp_path: Path) -> None:
    for name, program in LOGGERS.items():
        (tmp_path / f"{name}.py").write_text(program, "utf-8")
    tensorboard, weights_and_biases = blocks(DOCS / "loggers.md")

    lines = printed(tensorboard, tmp_path)
    evaluated = [line.split()[-1] for line in lines if line.startswith("evaluation/distance_m 0.")]
    assert evaluated == ["50", "100", "150", "200"]
    assert sum(line.startswith("practice/") for line in lines) == 200  # whole numbers
    assert lines[-1] == "closed"

    lines = printed(weights_and_biases, tmp_path)
    assert lines[0] == "hexapods {'alpha': 0.3, 'steps': 200, 'seed': 0}"
    assert [line.split()[-1] for line in lines[1:-1]] == ["50", "100", "150", "200"]
    assert lines[-1].startswith("{'greedy_distance_m': 0.49")


@pytest.mark.parametrize("page", ["your-agent", "your-robot", "jupyterhub"])
def test_the_program_of_a_page_runs(page: str, tmp_path: Path) -> None:
    shutil.copy(EXAMPLES / "my_agent.py", tmp_path)
    [program] = blocks(DOCS / f"{page}.md")
    printed(program, tmp_path)


def test_a_network_races_by_its_best_legal_action(tmp_path: Path) -> None:
    [program] = blocks(DOCS / "deep-learners.md")
    [race] = printed(program, tmp_path)
    assert re.fullmatch(r"<Race over 50 steps: DQN 0\.\d\d m, greedy 0\.53 m>", race)


def test_the_lesson_is_one_and_asks_runs_and_reveals() -> None:
    [text] = fenced("your-lesson", "yaml")
    lesson = read_file(text.encode(), "ice.yaml")
    first, second = lesson.cards
    assert (first.go, first.ask and first.ask.kind, [*first.may]) == (
        "training",
        "number",
        ["alpha"],
    )
    assert first.form["world"] == "ice"
    assert (second.go, second.ask) == (None, None)


@pytest.mark.skipif(shutil.which("sqlite3") is None, reason="the script needs sqlite3")
def test_the_backup_of_a_server_that_runs_is_a_data_folder(tmp_path: Path) -> None:
    script, backups = fenced("backups", "sh")[0], tmp_path / "backups"
    (backups / "2001-01-01").mkdir(parents=True)
    subprocess.run(["touch", "-d", "2001-01-01", backups / "2001-01-01"], check=True)
    with opened(tmp_path / "data", None) as store:
        ended_training(store, "00000000000t1")
        ended_race(store, "00000000000r1", "00000000000t1")
        for _ in range(2):  # a second backup of the day takes the place of the first
            subprocess.run(
                ["sh", "-c", script, "hexapods-backup", str(backups)],
                env={"PATH": "/usr/bin:/bin", "HEXAPODS_DATA": str(tmp_path / "data")},
                check=True,
            )
    [backup] = backups.iterdir()
    data = ("--data", str(backup))
    listed = output("runs", "list", *data, folder=tmp_path, run=in_process)
    assert {run["id"] for run in listed["items"]} == {"00000000000t1", "00000000000r1"}
    exported = in_process(
        "export", "00000000000t1", "00000000000r1", *data, "--out", "runs.zip", folder=tmp_path
    )
    assert exported.returncode == 0, exported.stderr
    assert (tmp_path / "runs.zip").stat().st_size > 10_000
