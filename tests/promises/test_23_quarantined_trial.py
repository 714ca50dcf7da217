"""Promise 23: a poisonous trial is quarantined.

A trial that kills its worker's process with SIGKILL at each attempt is tried three times and then
set aside: it is named in the summary and in the report, and all others complete with the results
that they have without it. In full: on MuJoCo, with five poisonous trials among a hundred.
"""

from pathlib import Path

import pytest
from playwright.sync_api import Page

from hexapods.experiments.cluster import ClusterSpec
from hexapods.experiments.config import ExperimentConfig, experiment_config
from hexapods.experiments.engine import run_trials
from hexapods.experiments.folder import ResultsFolder, open_results
from hexapods.experiments.plan import Plan
from hexapods.experiments.summary import summarise
from tests.experiments.clusters import CRASHING, one_by_one
from tests.experiments.crashing_agent import FOLDER, set_crashes, tries
from tests.experiments.report.opened import opened, text_of
from tests.promises.length import at_length

pytestmark = pytest.mark.test

CONFIG: ExperimentConfig = experiment_config(
    "sweep",
    {
        "seeds": at_length(10, 25),
        "simulator": at_length("kinematic", "mujoco"),
        "agents": (CRASHING, "tests.own_agents:Restless"),
        "gaits": ("left-right-origin", "front-back-origin"),
        "steps": (20,),
    },
)


def run_undone(folder: ResultsFolder) -> None:
    """Run the trials without a result, as the command does."""
    recorded = {**folder.results, **folder.set_aside}
    undone = [trial for trial in Plan(CONFIG).trials() if trial.key not in recorded]
    for outcome in run_trials(undone, ClusterSpec(workers=2)):
        folder.add(outcome)


@pytest.mark.timeout(at_length(120, 1200))
def test_a_trial_that_kills_its_worker_three_times_is_set_aside_and_the_rest_completes(
    page: Page, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(FOLDER, str(tmp_path))
    trials = list(Plan(CONFIG).trials())
    crashing = [t for t in trials if t.config.training.agent == CRASHING][3::9]
    crashing = crashing[: at_length(1, 5)]
    set_crashes(tmp_path, [(trial.config.training.seed, "kill") for trial in crashing])

    with open_results(tmp_path / "results", CONFIG) as folder:
        run_undone(folder)
        assert tries(tmp_path) == ["kill"] * 3 * len(crashing)
        run_undone(folder)
        assert len(tries(tmp_path)) == 3 * len(crashing), (
            "a trial set aside must not be tried again"
        )
        summary = summarise(CONFIG, folder.results, folder.set_aside)
        results = dict(folder.results)

    keys = {trial.key for trial in crashing}
    reasons = {trial["key"]: trial["reason"] for trial in summary["trials"]["set_aside"]}
    assert reasons == dict.fromkeys(keys, "it ended its worker's process 3 times")
    assert summary["trials"]["done"] == len(trials) - len(crashing)
    opened(page, tmp_path, summary)
    report = text_of(page)
    for entry in summary["trials"]["set_aside"]:
        label = entry["label"].replace("\xa0", " ")
        assert f"{label} was set aside: {entry['reason']}" in report
    set_crashes(tmp_path, [])
    assert results == one_by_one(trial for trial in trials if trial.key not in keys)
