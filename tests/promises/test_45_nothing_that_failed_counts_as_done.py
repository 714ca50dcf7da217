"""Promise 45: nothing that failed counts as done.

Agents that raise, that end their process and that no process can import, in experiments, sweeps
and races, in Python and on the command line: each failure is told where the result is
returned and printed, its reason too, and the exit code is 1. In full: the same.
"""

import json
import subprocess
import sys
import types
import warnings
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page

import hexapods as hx
from hexapods.experiments.report.trials_csv import trials_csv
from tests.cli.running import in_process
from tests.experiments.report.opened import opened, text_of
from tests.own_agents import Clumsy

QUICK: dict[str, Any] = {"simulator": "kinematic", "gaits": "left-right-origin", "workers": 1}
ON_COMMAND_LINE = ("--gait", "left-right-origin", "--simulator", "kinematic")
TRIPPED = "I tripped"


def test_failed_trials_are_reported_where_the_result_is_returned_and_printed(
    page: Page, tmp_path: Path
) -> None:
    with pytest.warns(UserWarning, match=r"2 of 5 trials failed.*Clumsy.*I tripped"):
        done = hx.experiment("sweep", agents=[hx.Sarsa, Clumsy], seeds=2, steps=5, **QUICK)
    assert done.summary["trials"]["failed"] == 2
    assert len(done.failed) == 2
    assert all(TRIPPED in reason for reason in done.failed.values())
    assert all("Clumsy" in name for name in done.failed)
    by_agent = {
        setting.name.partition(",")[0]: (setting.seeds, setting.failed) for setting in done.settings
    }
    assert by_agent == {"Greedy": (1, 0), "Sarsa": (2, 0), "Clumsy": (0, 2)}
    assert [setting["failed"] for setting in done.summary["settings"]] == [0, 0, 2]
    opened(page, tmp_path, done.summary)
    for shown in (repr(done), done._repr_html_(), text_of(page)):
        assert "2 of 5 trials failed" in shown.replace("&nbsp;", " ")
        assert TRIPPED in shown
    set_aside = {trial["key"]: trial["reason"] for trial in done.summary["trials"]["set_aside"]}
    assert trials_csv(done.config, done.trials, set_aside).decode().count(TRIPPED) == 2


def test_an_experiment_without_failures_warns_of_nothing() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        done = hx.experiment("sweep", agents="sarsa", seeds=1, steps=5, **QUICK)
    assert (done.summary["trials"]["failed"], done.failed) == (0, {})
    assert "failed" not in repr(done)


def test_a_class_that_no_process_can_import_is_refused_at_the_call() -> None:
    class Local(hx.QLearning):
        pass

    module = types.ModuleType("made_by_hand")
    module.Agent = type("Agent", (hx.QLearning,), {"__module__": "made_by_hand"})  # type: ignore[attr-defined]
    sys.modules["made_by_hand"] = module
    try:
        agents: list[Any] = [Local, lambda: 1, module.Agent, "made_by_hand:Agent"]
        for agent in agents:
            with pytest.raises(hx.InvalidInput, match=r"module|by its name or its class"):
                hx.experiment("sweep", agents=[agent], seeds=1, steps=5, **QUICK)
    finally:
        del sys.modules["made_by_hand"]


NOTEBOOK = f"""
import hexapods as hx
class Mine(hx.QLearning):
    pass

try:
    hx.experiment("sweep", agents=[Mine], seeds=1, steps=5, **{QUICK})
except hx.InvalidInput as error:
    print("refused:", error)

"""


def test_a_class_of_a_prompt_is_refused_and_one_of_a_program_is_not(tmp_path: Path) -> None:
    prompt = subprocess.run(
        [sys.executable, "-i", "-q"],
        input=NOTEBOOK,
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert "refused: Mine is defined in a notebook or at a prompt" in prompt.stdout, prompt.stderr
    assert "write it into a module, such as my_agents.py" in prompt.stdout
    program = tmp_path / "program.py"
    call = f"hx.experiment('sweep', agents=[Mine], seeds=1, steps=5, **{QUICK})"
    program.write_text(
        "import hexapods as hx\nclass Mine(hx.QLearning):\n    pass\n"
        f"if __name__ == '__main__':\n    print({call}.summary['trials']['failed'])\n"
        "    class Guarded(hx.QLearning):\n        pass\n    try:\n"
        f"        {call.replace('Mine', 'Guarded')}\n"
        "    except hx.InvalidInput as error:\n        print('refused:', error)\n"
    )
    done = subprocess.run(
        [sys.executable, program.name], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.stdout.startswith("0\nrefused: Guarded is defined"), (done.stdout, done.stderr)


@pytest.mark.parametrize(
    "command",
    [
        (
            "sweep",
            "--agent",
            "sarsa,tests.own_agents:Stumbling",
            "--seeds",
            "1",
            "--steps",
            "5",
            "--workers",
            "1",
        ),
        (
            "experiment",
            "figure4",
            "--agent",
            "tests.own_agents:Stumbling",
            "--seeds",
            "1",
            "--workers",
            "1",
        ),
        (
            "race",
            "--lane",
            "wave",
            "--lane",
            "tests.own_agents:Stumbling,keep_learning=true",
            "--steps",
            "5",
        ),
    ],
    ids=lambda command: command[0],
)
def test_a_command_that_computed_a_failure_prints_it_and_exits_with_1(
    command: tuple[str, ...], tmp_path: Path
) -> None:
    done = in_process(*command, *ON_COMMAND_LINE, folder=tmp_path)
    assert done.returncode == 1, (done.stdout, done.stderr)
    assert TRIPPED in done.stdout
    printed = in_process(*command, *ON_COMMAND_LINE, "--json", folder=tmp_path)
    assert printed.returncode == 1, "read from its folder it has not become a success"
    assert TRIPPED in printed.stdout
    json.loads(printed.stdout)


def test_a_training_that_fails_has_no_table(tmp_path: Path) -> None:
    train = (
        "train",
        "--agent",
        "tests.own_agents:Stumbling",
        "--out",
        "q.npz",
        "--steps",
        "5",
        *ON_COMMAND_LINE,
    )
    with pytest.raises(RuntimeError, match=TRIPPED):  # with its traceback, for who wrote the agent
        in_process(*train, folder=tmp_path)
    assert not (tmp_path / "q.npz").exists()


def test_a_failed_lane_is_reported_where_the_race_is_shown() -> None:
    done = hx.race(["wave", hx.lane(Clumsy, keep_learning=True)], simulator="kinematic", steps=5)
    for shown in (repr(done), done._repr_html_()):
        assert TRIPPED in shown
