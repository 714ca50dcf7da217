"""A trial of an experiment as a run of its own: the same distance to the last bit."""

from typing import Any

import pytest

from app.features.experiments.start import ExperimentStart
from app.features.experiments.trial_runs import trial_start
from app.jobs.jobs import Jobs
from app.storage.database.store import RunStore
from hexapods.domain.errors import InvalidInput
from hexapods.domain.robot import robot
from hexapods.experiments.config import ExperimentConfig, experiment_config
from hexapods.experiments.plan import Plan
from hexapods.experiments.trial import run_trial
from hexapods.runs.results import RaceResult, TrainingResult
from tests.jobs.waiting import wait_until_ended
from tests.quick_robot import HASTY, QUICK_STEPS

SWEEP: dict[str, Any] = {
    "seeds": 2,
    "seed": 5,
    "gaits": ("left-right-origin",),
    "agents": ("sarsa", "look-ahead"),
    "robots": (robot({"preset": "compliant", "femur_m": 0.09, **QUICK_STEPS}),),
    "observations": ("commanded",),
    "steps": (40,),
    "alpha": (0.1,),
    "depth": (1,),
}
LEAGUE: dict[str, Any] = {
    "seeds": 2,
    "gaits": ("left-right-origin",),
    "agents": ("q-learning",),
    "robots": (HASTY,),
    "worlds": ("limp:legs=1,4",),
    "steps": (30,),
}


@pytest.mark.promises
@pytest.mark.parametrize(("name", "values"), [("sweep", SWEEP), ("league", LEAGUE)])
def test_a_trial_run_here_has_the_trials_distance(
    jobs: Jobs, store: RunStore, name: Any, values: dict[str, Any]
) -> None:
    config = experiment_config(name, values)
    experiment = jobs.start(ExperimentStart(config))
    jobs.stop(experiment.id)
    by_role = {trial.setting.key.rpartition("/")[2]: trial for trial in Plan(config).trials()}
    for trial in by_role.values():
        run = wait_until_ended(store, jobs.start(trial_start(config, experiment.id, trial.key)))
        assert run.state == "finished", run.error
        assert run.notes == f"Trial {trial.key} of experiment {experiment.id}."
        assert isinstance(run.result, TrainingResult | RaceResult)
        result = run.result.lanes[0] if isinstance(run.result, RaceResult) else run.result
        distance_m = getattr(result, "total_distance_m", getattr(result, "distance_m", None))
        assert distance_m == run_trial(trial.config).distances_m[-1], trial.key


def test_what_no_single_run_repeats_is_refused() -> None:
    def refusal(config: ExperimentConfig, key: str) -> str:
        with pytest.raises(InvalidInput) as error:
            trial_start(config, "x", key)
        return str(error.value)

    figure4 = experiment_config("figure4", {"seeds": 1})
    in_blocks = next(t.key for t in Plan(figure4).trials() if t.config.blocks > 1)
    assert "blocks" in refusal(figure4, in_blocks)
    table1 = experiment_config("table1", {"seeds": 1})
    timed = next(t.key for t in Plan(table1).trials() if t.config.rivals)
    assert "wall times" in refusal(table1, timed)
    assert "has no trial 'no#1'" in refusal(table1, "no#1")
