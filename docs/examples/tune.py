"""Tunes the settings of a learner by Optuna, and judges the best of them on held-out seeds.

    pip install "racing-hexapods[tuning]"
    python tune.py q-learning --settings alpha,gamma --candidates 40

The settings and their ranges are those that the agent declares. Each candidate is a sweep of one
setting over the same seeds (`hx.experiment`); the defaults are the first. Optuna stores each in
`tuning.log` as it ends, so the same command goes on from there, also with more `--candidates`, and
draws in `tuning.png` what came of each setting's values. The best of many candidates is also the
luckiest: so the best and the defaults practise on seeds that the search never saw, and the
difference, paired by seed, has a 95 % interval.
"""

import argparse
import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np
import optuna
from optuna.distributions import CategoricalDistribution, FloatDistribution, IntDistribution
from optuna.exceptions import ExperimentalWarning
from optuna.storages import JournalStorage
from optuna.storages.journal import JournalFileBackend
from optuna.trial import TrialState
from optuna.visualization.matplotlib import plot_slice

import hexapods as hx
from hexapods.agents.registry import find, settings_of
from hexapods.domain.settings import DeclaredSetting
from hexapods.domain.types import FloatArray
from hexapods.experiments.statistics import MIN_SEEDS, iqm, paired_interval

SEARCH_SEED, HELD_OUT_SEED = 0, 1
"""Root seeds of the search and of the comparison: their trials share no seed."""


def distribution(setting: DeclaredSetting) -> Any:
    """Return where to search a setting; None if its declaration has no limits or choices."""
    if setting.choices or bool in setting.kinds:
        return CategoricalDistribution(setting.choices or (False, True))
    if setting.low is None or setting.high is None:
        return None
    if setting.is_whole:
        return IntDistribution(int(setting.low), int(setting.high))
    margin = 1e-3 * (setting.high - setting.low)
    low = setting.low + margin * setting.excludes_low
    high = setting.high - margin * setting.excludes_high
    return FloatDistribution(low, high, log=low > 0 and high / low >= 100)


def distances_m(problem: Mapping[str, Any], settings: Mapping[str, Any]) -> FloatArray:
    """Return the distance that each seed's learner walks after its practice [m], (n,).

    One whose trial failed, of which `hx.experiment` warns, walked 0 m.
    """
    rows = hx.experiment("sweep", **problem, **settings).table().rows
    return np.array([row["distance_m"] or 0.0 for row in rows if row["role"] == "learner"])


def main() -> None:
    """Search, draw what each setting brings, and compare the best with the defaults."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("agent", help="such as q-learning, or my_module:Agent")
    parser.add_argument("--settings", help="by commas (default: all with limits or choices)")
    parser.add_argument("--gait", default="left-right-origin")
    parser.add_argument("--simulator", default="mujoco")
    parser.add_argument("--steps", type=int, default=500, help="of practice (default 500)")
    parser.add_argument("--candidates", type=int, default=40, help="to try (default 40)")
    parser.add_argument("--seeds", type=int, default=8, help="of each candidate (default 8)")
    parser.add_argument("--held-out", type=int, default=30, help="seeds to compare on (default 30)")
    options = parser.parse_args()
    if options.held_out < MIN_SEEDS:
        parser.error(f"--held-out must be {MIN_SEEDS} or more: fewer seeds have no interval")
    problem = {"agents": options.agent, "gaits": options.gait, "simulator": options.simulator}
    problem["steps"] = options.steps
    declared = settings_of(find(options.agent))
    names = options.settings.split(",") if options.settings else [*declared]
    if unknown := [name for name in names if name not in declared]:
        raise hx.UnknownName("setting", unknown[0], declared)
    space = {name: distribution(declared[name]) for name in names}
    space = {name: values for name, values in space.items() if values is not None}

    study = optuna.create_study(
        storage=JournalStorage(JournalFileBackend("tuning.log")),
        study_name=options.agent,
        direction="maximize",
        load_if_exists=True,
    )
    # A search that goes on draws other candidates than it began with.
    study.sampler = optuna.samplers.TPESampler(seed=SEARCH_SEED + len(study.trials))
    study.enqueue_trial({name: declared[name].default for name in space}, skip_if_exists=True)
    search = {**problem, "seeds": options.seeds, "seed": SEARCH_SEED}
    while len(study.get_trials(states=[TrialState.COMPLETE])) < options.candidates:
        trial = study.ask(space)
        study.tell(trial, float(distances_m(search, trial.params).mean()))
    warnings.simplefilter("ignore", ExperimentalWarning)  # of the plots
    np.ravel(plot_slice(study))[0].figure.savefig("tuning.png")

    held_out = {**problem, "seeds": options.held_out, "seed": HELD_OUT_SEED}
    pairs_m = np.array([distances_m(held_out, {}), distances_m(held_out, study.best_params)])
    default_m, tuned_m = iqm(pairs_m)
    gain_m = paired_interval([pairs_m], lambda iqms: iqms[1] - iqms[0], HELD_OUT_SEED)
    print(f"Best in the search: {study.best_params}, {study.best_value:.3f} m")
    print(
        f"On {options.held_out} held-out seeds: {tuned_m:.3f} m, and {default_m:.3f} m by default"
    )
    print(f"Gain: {gain_m.value:.3f} m (95 % interval {gain_m.low:.3f} to {gain_m.high:.3f})")
    if gain_m.exceeds(0.0) != "yes":
        print("That the tuned settings are better is not established.")


if __name__ == "__main__":
    main()
