"""People read the names of settings and trials; their keys are in machine-readable files only."""

from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page

from hexapods.domain.text import MAX_NAME
from hexapods.experiments.config import experiment_config
from hexapods.experiments.labels import world_name
from hexapods.experiments.names import experiment_name, setting_names, trial_names
from hexapods.experiments.plan import Plan
from hexapods.experiments.summary import summarise
from tests.experiments.report.opened import opened, text_of
from tests.experiments.sample_experiments import around, config, sample_results

GAITS = ("left-right-origin", "left-right-vertical")
SAMPLES: list[tuple[str, dict[str, Any]]] = [
    ("table1", {}),
    ("sweep", {"alpha": (0.3, 0.6)}),
    ("league", {"agents": ("q-learning", "beam"), "worlds": ("flat", "noise")}),
]


def sample(experiment: str, options: dict[str, Any]) -> dict[str, Any]:
    """Summarise an experiment of which trials failed and were set aside."""
    tried = config(experiment, seeds=3, gaits=GAITS, **options)
    results = sample_results(
        tried, lambda setting: around(0.3, 0.1 if "0.6" in setting.key else 0.02)
    )
    if experiment == "league":
        for trial in Plan(tried).trials():
            walks = (0.3,) * max(1, len(trial.config.evaluations))
            results[trial.key] = results[trial.key].__class__(distances_m=walks)
    *_, last = Plan(tried).trials()
    results.pop(last.key)
    return summarise(tried, results, {last.key: "it killed its worker"})


@pytest.mark.parametrize(("experiment", "options"), SAMPLES, ids=[name for name, _ in SAMPLES])
def test_no_key_is_in_what_people_read(
    page: Page, tmp_path: Path, experiment: str, options: dict[str, Any]
) -> None:
    opened(page, tmp_path, sample(experiment, options))
    # In the command names are meant to be typed.
    page.locator(".making code").evaluate("(command) => command.remove()")
    text = text_of(page)
    for words in ("/measured", "left-right-origin", "q-learning", "alpha"):
        assert words not in text
    assert "Q-learning" in text


def test_the_setting_of_a_sweep_that_spreads_most_is_named_in_words() -> None:
    texts = {section["heading"]: section["text"] for section in sample(*SAMPLES[1])["story"]}
    assert texts["One seed misleads"].startswith(
        "The setting that spreads most is Q-learning, α\u00a00.6, Left-right, "
    )


@pytest.mark.parametrize(("experiment", "options"), SAMPLES, ids=[name for name, _ in SAMPLES])
def test_each_setting_and_trial_has_a_name_of_its_own(
    experiment: str, options: dict[str, Any]
) -> None:
    plan = Plan(config(experiment, seeds=3, gaits=GAITS, **options))
    keys = [trial.key for trial in plan.trials()]
    names = trial_names(plan, keys)
    assert len(set(names.values())) == len(keys)
    assert trial_names(plan, ["left-right-origin/gone#1"]) == {
        "left-right-origin/gone#1": "left-right-origin/gone#1"
    }
    summary = sample(experiment, options)
    models = {entry["key"]: entry["plans_with"] for entry in summary["worlds"]}
    settings = summary["settings"]
    assert len(set(setting_names(settings, summary["parameters"], models).values())) == len(
        settings
    )


@pytest.mark.parametrize(
    ("world", "name"),
    [
        ("ice", "Ice"),
        ("limp:legs=1,4", "Limp legs (legs 1, 4)"),
        (
            "slope:degrees=4+weak:legs=2:torque_share=0.5",
            "Slope (slope 4.0) and Weak servos (legs 2; share of torque 0.5)",
        ),
        ("a world of a later version", "a world of a later version"),
    ],
)
def test_a_world_without_a_name_is_described_by_its_disturbances(world: str, name: str) -> None:
    assert world_name(world) == name


@pytest.mark.parametrize(
    ("experiment", "values", "name"),
    [
        ("table1", {"seeds": 30}, "Table 1 · 30 seeds"),
        ("figure4", {"seeds": 1, "agents": ("sarsa",)}, "Figure 4: Sarsa · 1 seed"),
        ("sweep", {"alpha": (0.1, 0.3, 0.8)}, "α 0.1, 0.3, 0.8 · 8 seeds"),
        (
            "sweep",
            {"epsilon_end": (0.0, 0.1), "steps": (100, 500)},
            "Final ε 0, 0.1 × Practice 100, 500 steps · 8 seeds",
        ),
        (
            "sweep",
            {"agents": ("beam", "q-learning"), "width": (2, 4)},
            "Beam, Q-learning × Width 2, 4 · 8 seeds",
        ),
        (
            "sweep",
            {"steps": tuple(range(1, 9))},
            "Practice in 8 values from 1 to 8 steps · 8 seeds",
        ),
        ("sweep", {"agents": ("linear-model",)}, "Linear model · 8 seeds"),
        ("league", {}, "League: 4 worlds · 8 seeds"),
        (
            "recovery",
            {"agents": ("q-learning",), "worlds": ("limp-pair", "ice")},
            "Recovery: Q-learning · Two limp legs, Ice · 8 seeds",
        ),
    ],
)
def test_experiment_is_named_by_what_it_varies(
    experiment: str, values: dict[str, Any], name: str
) -> None:
    assert experiment_name(experiment_config(experiment, {"seeds": 8, **values})) == name


def test_long_name_is_cut_before_its_seeds() -> None:
    worlds = tuple(f"weak:legs=1,2,3:torque_share=0.{n}" for n in (1, 2, 3))
    name = experiment_name(experiment_config("league", {"worlds": worlds}))
    assert len(name) == MAX_NAME
    assert name.endswith(" · 30 seeds")
