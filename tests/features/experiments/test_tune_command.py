"""`hexapods tune`, as a user runs it."""

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest

from hexapods.experiments.folder import TRIALS, open_results
from hexapods.experiments.trial import TrialResult
from hexapods.experiments.tuning.summary import summarise_tuning
from tests.cli.running import ROOT, hexapods, in_process, output, refusal
from tests.experiments.test_tuning import config, tuned
from tests.forked import start_hexapods
from tests.timeouts import LONG_S

PLACE = ("--gait", "left-right-origin", "--simulator", "kinematic", "--steps", "50")
SIZE = ("--candidates", "12", "--seeds", "3", "--held-out", "5", "--objective", "area")
TUNE = ("tune", "q-learning", *PLACE, *SIZE)


def kept(file: Path) -> dict[str, TrialResult]:
    """Return the stored results by key; check that no key is repeated."""
    _, *lines = file.read_text("utf-8").splitlines()
    trials = [json.loads(line) for line in lines]
    assert len({trial["key"] for trial in trials}) == len(trials)
    return {trial["key"]: TrialResult.from_json(trial["result"]) for trial in trials}


@pytest.mark.promises
def test_stopped_and_killed_it_goes_on_and_gives_what_an_unbroken_one_gives(tmp_path: Path) -> None:
    file, lines = tmp_path / "tuning-results" / TRIALS, 0
    for end in (signal.SIGTERM, signal.SIGKILL):
        with tempfile.TemporaryFile("w+", encoding="utf-8") as errors:
            environment = {"PATH": "/usr/bin:/bin"}
            process = start_hexapods((*TUNE, "--workers", "1"), environment, errors, tmp_path)
            while not file.exists() or len(file.read_bytes().splitlines()) < lines + 10:
                assert process.poll() is None
                time.sleep(0.02)
            process.send_signal(end)
            assert process.stdout is not None
            with process.stdout as printed:
                out = printed.read()
            code = process.wait(LONG_S)
            errors.seek(0)
            err = errors.read()
        lines = len(file.read_bytes().splitlines())
        if end == signal.SIGTERM:
            assert (code, err) == (130, "")
            assert f"Interrupted: {lines - 1} trials are kept in tuning-results; the same" in out

    done = hexapods(*TUNE, "--workers", "2", folder=tmp_path)
    assert (done.returncode, done.stderr) == (0, ""), "Optuna's log stays silent"
    first, *_ = done.stdout.splitlines()
    # greedy once, and five seeds of the defaults and of the tuned
    assert (
        "12 candidates for the settings of q-learning on 3 seeds each, then 5 held-out seeds"
        in first
    )
    assert ": about 47 trials on 2 workers, kept in" in first
    assert first.endswith(" are there already")
    for text in ("Q-learning, defaults", "Greedy", "12 candidates for the settings of Q-learning"):
        assert text in done.stdout
    assert done.stdout.rstrip().endswith("The report is tuning-results/report.html.")

    tuning, progress = tuned(config(steps=(50,), candidates=12, search_seeds=3, objective="area"))
    assert kept(file) == progress.results
    expected = json.loads(json.dumps(summarise_tuning(tuning, progress, workers=None)))
    again = output(*TUNE, folder=tmp_path, run=in_process)
    assert {**again, "cost": None} == {**expected, "cost": None}
    assert {one.name for one in file.parent.iterdir()} == {
        TRIALS,
        "report.html",
        "summary.json",
        "trials.csv",
    }


@pytest.mark.parametrize(
    ("arguments", "names"),
    [
        (("greedy", *PLACE), "greedy does not learn, so there is nothing to tune; choose one of:"),
        (("skynet", *PLACE), "linear-model, greedy"),
        (("tests.own_agents:Restless", *PLACE), "has no settings, so there is nothing to tune"),
        (("q-learning",), "--gait"),
        (("q-learning", "--gait", "moonwalk"), "left-right-origin"),
        (("q-learning", *PLACE, "--world", "moon"), "limp-pair"),
        (("q-learning", *PLACE, "--world", "ice"), "the kinematic simulator knows"),
        (("q-learning", *PLACE, "--world", "limp:legs=1:at=4"), "leave out at and until"),
        (("q-learning", *PLACE, "--candidates", "0"), "candidates must be from 1 to 10,000, not 0"),
        (("q-learning", *PLACE, "--candidates", "many"), "must be a whole number"),
        (("q-learning", *PLACE, "--seeds", "0"), "from 1 to 10,000"),
        (("q-learning", *PLACE, "--held-out", "0"), "held-out must be from 1"),
        (("q-learning", *PLACE, "--settings", "alpha,beta"), "alpha, gamma"),
        (("q-learning", *PLACE, "--range", "alpha=0.1:2"), "over 0 and at most 1"),
        (("q-learning", *PLACE, "--range", "alpha"), "NAME=LOW:HIGH"),
        (("q-learning", *PLACE, "--objective", "speed"), "distance"),
        (("q-learning", *PLACE, "--range", "alpha=1:0.5"), "LOW must be below HIGH"),
        (("q-learning", *PLACE, "--beside", "skynet"), "linear-model, greedy"),
        (("q-learning", *PLACE, "--beside", "q-learning"), "leave it out of --beside"),
        (("q-learning", *PLACE, "--workers", "0"), "workers must be from 1 to 512"),
        (("q-learning", *PLACE, "--scheduler", "127.0.0.1"), "tcp://HOST:PORT"),
        (("q-learning", *PLACE, "--out", "/proc/nowhere"), "cannot keep results in"),
    ],
)
def test_invalid_input_is_refused_in_one_sentence(
    arguments: tuple[str, ...], names: str, tmp_path: Path
) -> None:
    assert names in refusal("tune", *arguments, folder=tmp_path, run=in_process)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("changed", "option"),
    [
        (("--seeds", "4"), "--seeds"),
        (("--objective", "distance"), "--objective"),
        (("--settings", "alpha"), "--settings or --range"),
        (("--beside", "r-max"), "the agent or --beside"),
        (("--gait", "front-back-origin", "--seed", "1"), "--seed, --gait"),
    ],
)
def test_resumed_with_other_options_it_names_those_that_differ(
    changed: tuple[str, ...], option: str, tmp_path: Path
) -> None:
    begun = config(steps=(50,), candidates=12, search_seeds=3, objective="area")
    with open_results(tmp_path / "mine", begun):
        pass

    sentence = refusal(*TUNE, *changed, "--out", "mine", folder=tmp_path, run=in_process)
    assert sentence.endswith(f"which differs in {option}; choose another folder")


def test_results_of_another_experiment_are_refused(tmp_path: Path) -> None:
    folder = ("--out", "mine", "--workers", "1", "--seeds", "1")
    league = ("experiment", "league", *PLACE, "--agent", "r-max", *folder)
    assert in_process(*league, folder=tmp_path).returncode == 0

    sentence = refusal(*TUNE, "--out", "mine", folder=tmp_path, run=in_process)
    assert sentence.endswith("mine has results of another experiment; choose another folder")


@pytest.mark.promises
def test_nothing_but_a_tuning_imports_optuna(tmp_path: Path) -> None:
    code = (
        "import sys, app.server, app.cli; app.cli._parser(); print('optuna' in sys.modules); "
        "import hexapods.experiments.tuning.tuning; print('optuna' in sys.modules)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.split() == ["False", "True"]
