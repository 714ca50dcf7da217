"""`hexapods experiment` and `hexapods sweep`, as a user runs them."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from hexapods.experiments.folder import TRIALS
from tests.cli.running import EXAMPLES, ROOT, hexapods, in_process, output, refusal

ONE_GAIT = ("--gait", "left-right-origin", "--simulator", "kinematic")
SWEEP = ("sweep", *ONE_GAIT, "--alpha", "0.1,0.3", "--steps", "50")


def start(*arguments: str, folder: Path) -> "subprocess.Popen[str]":
    """Start a command in a session of its own, as a terminal does."""
    return subprocess.Popen(
        [sys.executable, "-m", "app.cli", *arguments],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def kept(folder: Path) -> dict[str, Any]:
    """Return the stored results by key; check that no key is repeated."""
    _, *lines = (folder / TRIALS).read_text("utf-8").splitlines()
    trials = [json.loads(line) for line in lines]
    assert len({trial["key"] for trial in trials}) == len(trials)
    return {trial["key"]: trial["result"] for trial in trials}


def test_sweep_prints_its_progress_and_writes_a_report(tmp_path: Path) -> None:
    done = hexapods(*SWEEP, "--seeds", "4", "--workers", "1", folder=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("9 trials on 1 worker, kept in sweep-results\n")
    assert "α\u00a00.1" in done.stdout
    assert done.stdout.rstrip().endswith("The report is sweep-results/report.html.")
    folder = tmp_path / "sweep-results"
    assert len(kept(folder)) == 9
    assert {"report.html", "summary.json", "trials.csv"} <= {p.name for p in folder.iterdir()}
    assert sorted(p.name for p in tmp_path.iterdir()) == ["sweep-results"]


def test_table1_prints_json_and_adds_seeds_in_the_same_folder(tmp_path: Path) -> None:
    settings = ("--robot", "stiff", "--out", "here", "--workers", "1")
    table1 = ("experiment", "table1", *ONE_GAIT, *settings)
    first = output(*table1, "--seeds", "2", folder=tmp_path, run=in_process)
    # 2 readings × (greedy, two-step, 2 practices over 2 seeds, 1 race by the wall)
    assert first["trials"]["done"] == first["trials"]["total"] == 2 * (2 + 2 * 2 + 1)
    before = kept(tmp_path / "here")
    more = output(*table1, "--seeds", "3", folder=tmp_path, run=in_process)
    assert more["trials"]["done"] == 2 * (2 + 2 * 3 + 1)
    assert before.items() < kept(tmp_path / "here").items()
    assert {lane["agent"] for timed in more["timed"] for lane in timed["lanes"]} == {
        "q-learning",
        "greedy",
        "two-step",
    }


@pytest.mark.promises
def test_custom_agent_is_compared_and_its_failed_trials_are_retried(tmp_path: Path) -> None:
    agent = tmp_path / "mine.py"
    shutil.copy(EXAMPLES / "my_agent.py", agent)
    text = agent.read_text("utf-8")
    assert "def act(" in text
    agent.write_text(text.replace("def act(", "def act(self, *_):\n        1 / 0\n\n    def _act("))
    agents = ("--agent", "q-learning", "--agent", "mine:Agent", "--workers", "1")
    figure4 = ("experiment", "figure4", *ONE_GAIT, "--observation", "measured", "--seeds", "3")
    done = hexapods(*figure4, *agents, folder=tmp_path)
    assert done.returncode == 1, done.stderr
    assert done.stdout.count("Set aside: ") == 2 * 3  # in blocks, and in one go
    assert "division by zero" in done.stdout

    agent.write_text(text, "utf-8")
    summary = output(*figure4, *agents, "--retry", folder=tmp_path)
    assert summary["trials"]["set_aside"] == []
    assert len(summary["versus"]) == 2  # in blocks, and in one go
    for versus in summary["versus"]:
        assert {versus["a"], versus["b"]} == {"q-learning", "mine:Agent"}
    assert [len(curve["steps"]) for curve in summary["curves"]] == [8, 8, 8, 8]


@pytest.mark.promises
def test_interrupted_sweep_is_resumed_by_the_same_command(tmp_path: Path) -> None:
    file = tmp_path / "kept" / TRIALS
    before: dict[str, Any] = {}
    # SIGINT to the process group, as a terminal sends it; SIGTERM to the process.
    for end in (lambda process: os.killpg(process.pid, signal.SIGINT), subprocess.Popen.terminate):
        options = ("--seeds", "400", "--workers", "1", "--out", "kept")
        process = start("sweep", *ONE_GAIT, *options, folder=tmp_path)
        while not file.exists() or len(file.read_bytes().splitlines()) < len(before) + 20:
            assert process.poll() is None
            time.sleep(0.05)
        end(process)
        out, err = process.communicate(timeout=60)
        assert (process.returncode, err) == (130, "")
        now = kept(tmp_path / "kept")
        assert before.items() < now.items()
        assert f"Interrupted: {len(now)} of 401 trials are kept in kept" in out
        assert "the same command goes on from there" in out
        before = now


def test_full_disk_ends_the_sweep_and_finished_trials_are_stored(tmp_path: Path) -> None:
    sweep = [sys.executable, "-m", "app.cli", *SWEEP, "--workers", "1"]
    done = subprocess.run(
        ["sh", "-c", 'ulimit -f 8; exec "$0" "$@"', *sweep],
        cwd=tmp_path,
        # Python would keep the compiled modules that it can write only in part.
        env={"PYTHONPATH": str(ROOT), "PATH": "/usr/bin:/bin", "PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True,
        text=True,
        timeout=100,
        check=False,
    )
    assert done.returncode == 2, (done.stdout, done.stderr)
    assert "the disk is full; what was done is kept" in done.stderr
    assert "Traceback" not in done.stderr
    assert kept(tmp_path / "sweep-results")


@pytest.mark.parametrize(
    ("arguments", "names"),
    [
        (("experiment", "table2"), "table1"),
        (("experiment",), "experiment"),
        (("experiment", "table1", "--seeds", "0"), "from 1 to 10,000, not 0"),
        (("experiment", "table1", "--seeds", "many"), "a whole number"),
        (("experiment", "table1", "--seed", "-1"), "at least 0"),
        (("experiment", "table1", "--gait", "moonwalk"), "left-right-origin"),
        (("experiment", "table1", "--gait", "all,all"), "gaits names something twice"),
        (("experiment", "table1", "--observation", "guessed"), "measured, commanded, planned"),
        (("experiment", "table1", "--robot", "stiff,sloth"), "stiff, compliant, slippery"),
        (("experiment", "table1", "--robot", "stiff,stiff"), "robots names something twice"),
        (("experiment", "table1", "--simulator", "matrix"), '"mujoco", "kinematic"'),
        (("experiment", "table1", "--agent", "greedy"), "--agent is for figure4, league"),
        (
            ("experiment", "figure4", "--agent", "skynet"),
            "linear-model, tamer, greedy, two-step",
        ),
        (("experiment", "table1", "--workers", "0"), "workers must be from 1 to 512"),
        (
            ("experiment", "table1", "--workers", "2", "--scheduler", "tcp://127.0.0.1:9"),
            "either workers on this machine or a scheduler",
        ),
        (("experiment", "table1", "--scheduler", "127.0.0.1"), "tcp://HOST:PORT"),
        (("experiment", "table1", "--scheduler", "tls://h:1"), "a CA, a certificate and its key"),
        (("experiment", "table1", "--out", "/proc/nowhere"), "cannot keep results in"),
        (("sweep", "--gait", "all", "--alpha", "0.1,2"), "over 0 and at most 1"),
        (("sweep", "--alpha", "0.1,"), "must be a number"),
        (("sweep", "--divisions", "2.5"), "a whole number"),
        (("sweep", "--grid-side-m", "0.2"), "cannot reach"),
    ],
)
def test_invalid_input_is_refused_in_one_sentence(
    arguments: tuple[str, ...], names: str, tmp_path: Path
) -> None:
    assert names in refusal(*arguments, folder=tmp_path, run=in_process)
    assert list(tmp_path.iterdir()) == []


def test_unreachable_scheduler_is_refused_in_one_sentence(tmp_path: Path) -> None:
    sentence = refusal(*SWEEP, "--scheduler", "tcp://127.0.0.1:9", folder=tmp_path)
    assert "no scheduler answers at tcp://127.0.0.1:9" in sentence
    assert "`dask scheduler`" in sentence


def test_foreign_results_folder_is_refused(tmp_path: Path) -> None:
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.txt").touch()
    sentence = refusal(*SWEEP, "--out", "mine", folder=tmp_path, run=in_process)
    assert "mine is not empty, and has no results in it" in sentence
    (tmp_path / "mine" / TRIALS).write_text('{"format": 9, "versions": {}, "config": {}}\n')
    sentence = refusal(*SWEEP, "--out", "mine", folder=tmp_path, run=in_process)
    assert f"{TRIALS} has format 9; this version reads 2 alone" in sentence


def test_league_compares_agents_in_worlds(tmp_path: Path) -> None:
    league = ("experiment", "league", *ONE_GAIT, "--agent", "linear-model,informed", "--seeds", "3")
    done = output(*league, "--steps", "30", "--world", "flat,noise", folder=tmp_path)
    # flat: greedy and informed once, noise: also the nominal greedy, of three seeds each
    assert done["trials"]["total"] == (2 + 3) + (3 * 3 + 3)
    assert {world["world"] for world in done["worlds"]} == {"flat", "noise"}
    folder = tmp_path / "league-results"
    assert len(kept(folder)) == done["trials"]["total"]
    assert b"league" in (folder / "report.html").read_bytes()


def test_table_of_a_league_has_the_shares_of_greedy_and_of_the_best_known(tmp_path: Path) -> None:
    league = ("experiment", "league", "--gait", "left-right-origin", "--agent", "q-learning")
    size = ("--world", "flat", "--steps", "5", "--seeds", "1", "--workers", "1", "--tolerance", "0")
    done = in_process(*league, *size, folder=tmp_path, COLUMNS="120")
    assert (done.returncode, done.stderr) == (0, "")
    summary = json.loads((tmp_path / "league-results" / "summary.json").read_text("utf-8"))
    (greedy,) = (world for world in summary["worlds"] if world["agent"] == "greedy")
    share = 100 * greedy["of_best_known"]["iqm"]

    lines = [re.split(" {2,}", line.strip()) for line in done.stdout.splitlines()]
    rows = {line[0]: line[-2:] for line in lines}
    assert rows["setting"] == ["of greedy", "of best known"]
    assert rows["Greedy"] == ["100\u00a0%", f"{share:.0f}\u00a0%"]


@pytest.mark.parametrize(
    ("arguments", "names"),
    [
        (("table1", "--world", "ice"), "--world is for league, recovery, groups and bodies"),
        (
            ("figure4", "--tolerance", "0.03"),
            "is for league, recovery, groups and bodies",
        ),
        (("table1", "--reward", "track"), "--reward is for league, recovery, groups and bodies"),
        (("league", "--reward", "sideways"), "forward, or track"),
        (("league", "--world", "moon"), "limp-pair"),
        (("league", "--tolerance", "0.5"), "from 0 to 0.2"),
        (("league", "--simulator", "kinematic", "--world", "ice"), "the kinematic simulator knows"),
        (("recovery", "--world", "limp:legs=9"), "legs 1 to 6"),
        (("recovery", "--world", "limp:legs=1:at=4"), "leave out at and until"),
        (("recovery", "--agent", "greedy"), "greedy does not learn"),
    ],
)
def test_invalid_worlds_and_tolerances_are_refused(
    arguments: tuple[str, ...], names: str, tmp_path: Path
) -> None:
    assert names in refusal("experiment", *arguments, folder=tmp_path, run=in_process)
    assert not list(tmp_path.iterdir())
