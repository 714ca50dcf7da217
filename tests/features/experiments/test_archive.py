"""Export and import of experiments: round trip, and rejection of invalid archives."""

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from app.features.archives import archive
from app.features.experiments.archived_trials import TRIALS
from app.features.experiments.trial_rows import Trials
from app.storage.database.store import RunStore
from app.storage.run import State
from hexapods.agents.registry import BUILT_IN
from hexapods.experiments.config import SUMMARY, experiment_config
from hexapods.experiments.plan import Plan
from hexapods.experiments.trial import run_trial
from hexapods.experiments.worker import Outcome
from tests.features.archives.exported import export_run
from tests.features.archives.test_transfer import (
    Change,
    _set,
    imported,
    refusal,
    repacked,
    rewritten,
)
from tests.features.experiments.ended_experiments import ended_experiment
from tests.storage.stores import SWEEP, experiment, opened

RUN_ID = "00000000000e1"


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunStore]:
    with opened(tmp_path_factory.mktemp("source"), None) as store:
        ended_experiment(store, RUN_ID)
        yield store


def members(data: bytes) -> dict[str, bytes]:
    return archive.unpack(data, "run.zip", lambda name: True)


def with_trials(data: bytes, change: Change) -> bytes:
    """Change the `trials.json` of an archive."""
    rows = json.loads(members(data)[TRIALS])
    change(rows)
    return repacked(data, trials_json=json.dumps(rows).encode())


def test_export_and_import_preserve_everything(source: RunStore, tmp_path: Path) -> None:
    data = export_run(source, RUN_ID)
    with opened(tmp_path, None) as target:
        assert imported(data, target) == source.get(RUN_ID)
        assert Trials(target.database).get(RUN_ID) == Trials(source.database).get(RUN_ID)
        for name in (SUMMARY, "trials.csv"):
            assert target.artifact(RUN_ID, name) == source.artifact(RUN_ID, name)
        assert export_run(target, RUN_ID) == data


def test_incomplete_experiments_are_imported_with_their_trials(
    source: RunStore, store: RunStore, tmp_path: Path
) -> None:
    config, rows = source.get(RUN_ID).config, Trials(source.database).get(RUN_ID)[:2]
    states: dict[str, State] = {"0000000000001": "interrupted", "0000000000002": "stopped"}
    for run_id, state in {**states, "0000000000003": "failed"}.items():
        run = experiment(run_id, state=state, config=config, total=4, done=2, workers=2)
        store.create(run)
        Trials(store.database).append(run_id, rows)
        with opened(tmp_path / run_id, None) as target:
            assert imported(export_run(store, run_id), target) == run
            assert Trials(target.database).get(run_id) == rows


def test_unregistered_agents_are_refused_without_importing_their_module(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, store: RunStore
) -> None:
    (tmp_path / "evil.py").write_text(f"open({str(tmp_path / 'ran')!r}, 'w')")
    monkeypatch.syspath_prepend(tmp_path)
    config = replace(SWEEP, agents=("q-learning", "evil:Agent"))
    store.create(experiment("a", state="failed", config=config))
    assert ", ".join(BUILT_IN) in refusal(export_run(store, "a"))
    assert not (tmp_path / "ran").exists()


@pytest.mark.parametrize(
    ("change", "names"),
    [
        (_set("kind", "race", "run"), "run.json"),
        (_set("kind", "training", "run"), "run.json"),
        (_set("total", 1_000, "run"), "total"),
        (_set("done", 5, "run"), "progress"),
        (_set("workers", 0, "run"), "workers"),
        (_set("workers", 10**6, "run"), "workers"),
        (_set("lane_training_ids", [None], "run"), "has lanes"),
        (_set("seeds", 0, "run", "config"), "seeds"),
        (_set("seeds", 10**9, "run", "config"), "seeds"),
        (_set("alpha", [n / 1000 for n in range(1, 999)], "run", "config", "settings"), "total"),
        (_set("grid_side_m", [0.5], "run", "config"), "cannot reach"),
        (_set("experiment", "table9", "run", "config"), "table1, figure4, sweep"),
        (_set("agents", ["my.module:Agent"], "run", "config"), "run.json"),
        (_set("colour", 1, "run", "config"), "colour"),
        (_set("files", ["../../x"], "run", "result"), "this experiment has not"),
        (_set("files", 3, "run", "result"), "files"),
        (_set("more", 3, "run", "result"), "more"),
        (_set("curve", [{"step": 5, "distance_m": 1, "epsilon": 0}]), "curve"),
    ],
)
def test_invalid_run_json_of_an_experiment_is_refused(
    source: RunStore, change: Change, names: str
) -> None:
    assert names in refusal(rewritten(export_run(source, RUN_ID), change))


def _again(rows: Any) -> None:
    rows.append(rows[0])


@pytest.mark.parametrize(
    ("change", "names"),
    [
        (_set("key", "left-right-origin/felt/stiff/greedy#0", 0), "none of this experiment"),
        (_set("key", 3, 0), "key"),
        (_set("compute_s", -1, 0), "compute_s"),
        (_set("compute_s", None, 0), "compute_s"),
        (_set("set_aside", "It broke.", 0), "neither or both"),
        (_set("result", None, 0), "neither or both"),
        (_set("distances_m", ["far"], 0, "result"), "distances_m"),
        (_set("distances_m", [0.1] * 2_000, 0, "result"), "distances_m"),
        (_set("more", 1, 0), "more"),
        (_again, "twice"),
    ],
)
def test_invalid_trials_are_refused(source: RunStore, change: Change, names: str) -> None:
    assert names in refusal(with_trials(export_run(source, RUN_ID), change))


def summary_with(data: bytes, **fields: Any) -> bytes:
    return json.dumps({**json.loads(members(data)[SUMMARY]), **fields}).encode()


def test_report_files_must_match_their_names(source: RunStore) -> None:
    data = export_run(source, RUN_ID)
    for changed, names in (
        ({"summary_json": b"{}"}, "no summary"),
        ({"summary_json": summary_with(data, cost={"wall_s": "long"})}, "no summary"),
        ({"summary_json": summary_with(data, format=1)}, "has format 1; this version reads 2"),
        ({"summary_json": summary_with(data, format=3)}, "has format 3; this version reads 2"),
        ({"trials_csv": b"key,failure\r\na,=1+1\r\n"}, "takes for a formula"),
        ({"trials_csv": b"key,failure\r\na,\xff\r\n"}, "no table"),
        ({"summary_json": b"[" * 100_000}, "no summary"),
        ({"trials_json": b"{}"}, "trials"),
        ({"trials_json": None}, "has no trials.json"),
        ({"report_html": b"<script>"}, "this experiment has not"),
        ({"q-table_npz": b"x"}, "this experiment has not"),
        ({"figures/x_exe": b"x"}, "which no run has"),
    ):
        assert names in refusal(repacked(data, **changed))


def test_rewards_of_a_recovery_are_preserved(store: RunStore, tmp_path: Path) -> None:
    values = {"seeds": 1, "simulator": "kinematic", "gaits": ("left-right-origin",), "steps": (5,)}
    config = experiment_config("recovery", {**values, "agents": ("q-learning",)})
    trials = list(Plan(config).trials())
    rows = [Outcome(trial.key, run_trial(trial.config), None, 0.1).as_json() for trial in trials]
    run = experiment(RUN_ID, state="stopped", config=config, total=3, done=len(rows), workers=1)
    store.create(run)
    Trials(store.database).append(RUN_ID, rows)

    with opened(tmp_path, None) as target:
        assert imported(export_run(store, RUN_ID), target).config == config
        assert list(Trials(target.database).get(RUN_ID)) == list(Trials(store.database).get(RUN_ID))
        assert len(Trials(target.database).get(RUN_ID)[-1]["result"]["earned_m"]) == 6
