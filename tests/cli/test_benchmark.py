"""`hexapods benchmark`, as a user runs it, and `hexapods verify` of its file."""

import json
import signal
import time
from pathlib import Path
from typing import Any

import pytest

from tests.cli.running import hexapods, in_process, output, refusal
from tests.forked import start_hexapods

SMALL = ("--tasks", "tripod", "--budget", "3,6", "--seeds", "3", "--workers", "1")
OWN = "my_agents:Walker"
PROGRAM = '''
from hexapods import QLearning


class Walker(QLearning):
    """Sets out like Q-learning."""


class Stumbler(QLearning):
    """Breaks at once."""

    def learn(self, transition):
        raise RuntimeError("I tripped")
'''


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with an agent of a user's own, and the score file `s.json` of it."""
    place = tmp_path_factory.mktemp("benchmark")
    (place / "my_agents.py").write_text(PROGRAM)
    done = hexapods("benchmark", OWN, *SMALL, "--out", "s.json", folder=place)
    assert done.returncode == 0, done.stderr
    (place / "printed.txt").write_text(done.stdout)
    return place


def test_it_prints_tasks_and_a_row_for_a_table(folder: Path) -> None:
    lines = (folder / "printed.txt").read_text().splitlines()
    assert lines[0] == "6 runs of hexabench-1 on 1 worker"
    assert any(line.startswith("Tripod") for line in lines)
    assert any(line.startswith("All tasks") for line in lines)
    assert any("part of the protocol" in line for line in lines)
    assert lines[-1].startswith(f"| `{OWN}` | hexabench-1 (part: tripod) | 3 | ")
    assert {file.name for file in folder.glob("s.json*")} == {"s.json"}, "runs are in the file"


def test_its_file_has_every_run_and_is_repeated_by_verify(folder: Path) -> None:
    content = score_file(folder)
    assert [len(entry["distances_m"]) for entry in content["tasks"][0]["budgets"]] == [3, 3]
    done = hexapods("verify", "s.json", "--workers", "1", folder=folder)
    assert done.returncode == 0, done.stderr
    assert "s.json repeats to the last digit: 6 runs, and all scores." in done.stdout


def test_a_changed_file_does_not_repeat(folder: Path) -> None:
    content = score_file(folder)
    content["tasks"][0]["budgets"][0]["distances_m"][1] = 0.6
    (folder / "changed.json").write_text(json.dumps(content))
    done = hexapods("verify", "changed.json", "--workers", "1", folder=folder)
    assert done.returncode == 1
    assert "tripod, 3 steps, seed 1: 0.6 m in the file, " in done.stdout
    assert "changed.json does not repeat" in done.stdout
    done = hexapods("verify", "changed.json", "--sample", "1", "--json", folder=folder)
    assert done.returncode == 1
    shown = json.loads(done.stdout)
    assert (shown["repeats"], shown["repeated_runs"]) == (False, 1)


def test_more_seeds_are_added_to_a_file(folder: Path, tmp_path: Path) -> None:
    content = score_file(folder)
    first = content["tasks"][0]["budgets"][0]["distances_m"]
    content["tasks"][0]["budgets"][0]["distances_m"][0] = 0.125  # to see that it was not repeated
    (tmp_path / "my_agents.py").write_text(PROGRAM)
    (tmp_path / "s.json").write_text(json.dumps(content))
    more = [*SMALL[:5], "4", *SMALL[6:]]
    done = output("benchmark", OWN, *more, "--out", "s.json", folder=tmp_path)
    distances = done["tasks"][0]["budgets"][0]["distances_m"]
    assert distances[:3] == [0.125, *first[1:]]
    assert len(distances) == 4


def test_it_takes_settings_of_the_agent(tmp_path: Path) -> None:
    done = output(
        *("benchmark", "q-learning", "--alpha", "0.5", "--tasks", "tripod", "--budget", "2"),
        *("--seeds", "1", "--workers", "1"),
        folder=tmp_path,
        run=in_process,
    )
    assert done["agent"]["settings"]["alpha"] == 0.5
    assert done["aggregate"]["interval"] is None


def test_a_run_that_fails_counts_as_0_and_the_exit_code_is_1(folder: Path) -> None:
    done = hexapods(
        *("benchmark", "my_agents:Stumbler", "--out", "failed.json", *SMALL), folder=folder
    )
    assert done.returncode == 1
    assert "Failed, counts as 0: tripod, 3 steps, seed 0: " in done.stdout
    assert "I tripped" in done.stdout
    assert done.stdout.splitlines()[-1].endswith("| 6 |")
    content = json.loads((folder / "failed.json").read_text())
    assert content["aggregate"]["score"] == 0.0
    assert len(content["tasks"][0]["errors"]) == 6


@pytest.mark.promises
def test_interrupted_it_goes_on_where_it_was(folder: Path) -> None:
    place = ("--tasks", "tripod", "--budget", "100,200", "--workers", "1")
    command = ["benchmark", OWN, *place, "--seeds", "3", "--out", "i.json"]
    with (folder / "errors.txt").open("w+") as errors:
        env = {"PATH": "/usr/bin:/bin", "HEXAPODS_DATA": str(folder / "data")}
        running = start_hexapods(command, env, errors, folder)
        runs_file = folder / "i.json.runs"
        while not (runs_file.exists() and len(runs_file.read_bytes().splitlines()) > 1):
            time.sleep(0.05)
        running.send_signal(signal.SIGINT)
        assert running.stdout is not None
        with running.stdout as printed:
            text = printed.read()
        assert running.wait() == 130
    assert "Interrupted; the same command goes on." in text
    before = runs_file.read_bytes().splitlines()[1:]
    done = output(*command, folder=folder)
    distances = {
        (entry["steps"], number): distance_m
        for entry in done["tasks"][0]["budgets"]
        for number, distance_m in enumerate(entry["distances_m"])
    }
    for line in before:
        _, steps, number, distance_m, _ = json.loads(line)
        assert distances[steps, number] == distance_m
    assert not runs_file.exists()


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("nobody",), "unknown agent 'nobody'; choose one of: q-learning, "),
        (("no.module:Agent",), "cannot import no.module"),
        (("q-learning", "--budget", "0"), "budget must be from 1 to 10,000,000, not 0"),
        (("q-learning", "--budget", "5,5"), "budgets names something twice"),
        (("q-learning", "--seeds", "0"), "seeds must be from 1 to 10,000, not 0"),
        (("q-learning", "--tasks", "moon"), "unknown task of hexabench-1 'moon'; choose one of: "),
        (("q-learning", "--tasks", "ice,ice"), "tasks names something twice"),
        (("q-learning", "--protocol", "x"), "unknown protocol 'x'; choose one of: hexabench-1"),
        (
            ("linear-model", "--objective", "average"),
            "--objective is no setting of linear-model, which has --prior, --optimism, --order; it "
            "is one of q-learning, double-q, ",
        ),
        (("greedy", "--budget", "100"), "greedy does not learn, so it has no budgets"),
        (("q-learning", "--observation", "seen"), 'Choose from: "measured", '),
        (("q-learning", "--out", "none/s.json"), "cannot write none/s.json"),
    ],
)
def test_bad_input_is_refused(arguments: tuple[str, ...], reason: str, tmp_path: Path) -> None:
    assert reason in refusal("benchmark", *arguments, folder=tmp_path, run=in_process)


def test_verify_refuses_other_files_and_protocols(folder: Path) -> None:
    (folder / "later.json").write_text('{"format": 1, "protocol": "hexabench-2"}')
    assert "unknown protocol 'hexabench-2'; choose one of: hexabench-1" in refusal(
        "verify", "later.json", folder=folder, run=in_process
    )
    (folder / "damaged.json").write_text('{"format": 1, "protocol": "hexabench-1"}')
    assert "damaged.json is no score file that can be read: it lacks 'agent'" in refusal(
        "verify", "damaged.json", folder=folder, run=in_process
    )


def score_file(folder: Path) -> Any:
    return json.loads((folder / "s.json").read_text())
