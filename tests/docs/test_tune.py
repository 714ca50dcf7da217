"""The example of a tuning searches, goes on where it was stopped, and judges on other seeds."""

import subprocess
import sys
from pathlib import Path

from optuna import load_study
from optuna.storages import JournalStorage
from optuna.storages.journal import JournalFileBackend

from tests.docs.programs import DOCS
from tests.timeouts import LONG_S

SMALL = ("--simulator", "kinematic", "--steps", "40", "--seeds", "2", "--held-out", "3")


def tune(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run the example in a folder."""
    return subprocess.run(
        [sys.executable, str(DOCS / "examples" / "tune.py"), *arguments, *SMALL],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=LONG_S,
        check=False,
    )


def test_a_search_goes_on_and_is_judged_on_held_out_seeds(tmp_path: Path) -> None:
    command = ("q-learning", "--settings", "alpha,objective")
    first = tune(tmp_path, *command, "--candidates", "2")
    assert first.returncode == 0, first.stderr
    assert "On 3 held-out seeds: " in first.stdout
    assert "95 % interval" in first.stdout
    assert (tmp_path / "tuning.png").read_bytes().startswith(b"\x89PNG")
    stored = (tmp_path / "tuning.log").read_text("utf-8")

    again = tune(tmp_path, *command, "--candidates", "2")
    assert again.stdout == first.stdout, "nothing is tried again"
    more = tune(tmp_path, *command, "--candidates", "3")
    assert more.returncode == 0, more.stderr
    assert (tmp_path / "tuning.log").read_text("utf-8").startswith(stored)
    storage = JournalStorage(JournalFileBackend(str(tmp_path / "tuning.log")))
    alphas = [
        trial.params["alpha"]
        for trial in load_study(study_name="q-learning", storage=storage).trials
    ]
    assert alphas[0] == 0.3, "the default"
    assert len({*alphas}) == 3, "what goes on draws other values"


def test_a_setting_that_does_not_exist_is_refused_with_those_that_do(tmp_path: Path) -> None:
    refused = tune(tmp_path, "q-learning", "--settings", "speed")
    assert refused.returncode != 0
    assert "epsilon_start" in refused.stderr
