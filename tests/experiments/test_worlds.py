"""Agents in the worlds of a league and a recovery, by hand and with made-up distances."""

import json
import math
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page

from app.features.experiments.response_models import SummaryView
from hexapods.domain.records import from_json
from hexapods.experiments.config import experiment_config
from hexapods.experiments.plan import Plan
from hexapods.experiments.report.trials_csv import trials_csv
from hexapods.experiments.summary import summarise
from hexapods.experiments.trial import TrialResult
from hexapods.experiments.worlds import mean_distance_m, steps_until
from hexapods.runs.best_known import kept
from tests.experiments.report.opened import opened, text_of

LRO = "left-right-origin"
WALKS_M = {"greedy": 0.5, "greedy/nominal": 0.1, "informed": 0.4}


def summary(experiment: str, curve_m: tuple[float, ...], **options: Any) -> dict[str, Any]:
    """Summarise made-up walks, in which each seed comes a millimetre farther than the last."""
    agents = ("q-learning", "informed") if experiment == "league" else ("q-learning",)
    gaits = {} if experiment == "bodies" else {"gaits": (LRO,)}
    values = {"seeds": 4, **gaits, "agents": agents, **options}
    config = experiment_config(experiment, values)
    results = {}
    for trial in Plan(config).trials():
        more_m = 0.001 * trial.seed_number
        walked_m = next(
            (m for end, m in WALKS_M.items() if trial.setting.key.endswith(f"/{end}")), None
        )
        distances_m = curve_m if walked_m is None else (walked_m,)
        earned_m = curve_m if trial.config.earning_steps else ()
        results[trial.key] = TrialResult(
            distances_m=tuple(metres + more_m for metres in distances_m), earned_m=earned_m
        )
    summarised = summarise(config, results)
    from_json(SummaryView, json.loads(json.dumps(summarised)))  # is what REST promises
    trials_csv(config, results, {})
    return summarised


def entry(league: dict[str, Any], agent: str, world: str) -> dict[str, Any]:
    (entry_of_agent,) = [
        entry_of_agent
        for entry_of_agent in league["worlds"]
        if (entry_of_agent["agent"], entry_of_agent["world"]) == (agent, world)
        and entry_of_agent["plans_with"] != "nominal"
    ]
    return dict(entry_of_agent)


def test_mean_distance_is_the_area_under_the_curve() -> None:
    # 0 → .2 m in 10 steps, then .2 → .4 m in 30: 1 + 9 over 40 steps
    assert mean_distance_m([10, 40], [0.2, 0.4]) == pytest.approx(10 / 40)
    # a recovery is evaluated at its start: .1 → .3 m in 10 steps
    assert mean_distance_m([0, 10], [0.1, 0.3]) == pytest.approx(0.2)


def test_steps_until_a_distance_are_those_of_the_first_evaluation() -> None:
    assert steps_until([25, 50, 100], [0.1, 0.4, 0.3], 0.4) == 50
    assert steps_until([25, 50, 100], [0.1, 0.4, 0.3], 0.41) == math.inf


def test_league_measures_learners_against_greedy_and_best_known() -> None:
    league = summary("league", (0.1, 0.3, 0.48), steps=(100,), worlds=("flat", "limp-pair"))
    learner = entry(league, "q-learning", "limp-pair")
    greedy_m, best_m = 0.5015, kept()["stiff", "limp-pair", LRO]  # greedy's mean over four seeds

    assert learner["curve"]["steps"] == [25, 50, 100]
    assert learner["distance"]["iqm"] == pytest.approx(0.4815)
    assert learner["greedy_m"] == pytest.approx(greedy_m)
    assert learner["greedy_nominal_m"] == pytest.approx(0.1015)
    assert learner["best_known_m"] == best_m
    assert learner["of_greedy"]["iqm"] == pytest.approx(0.4815 / greedy_m)
    assert learner["of_best_known"]["iqm"] == pytest.approx(0.4815 / best_m)
    assert learner["until_greedy"]["median_steps"] == 100
    assert learner["until_greedy"]["reached"] == 1
    assert learner["until_best_known"]["median_steps"] is None
    assert entry(league, "informed", "flat")["curve"] is None
    assert entry(league, "informed", "limp-pair")["plans_with"] == "world"
    assert learner["plans_with"] is None
    assert len(league["worlds"]) == 2 * 4


def test_recovery_counts_from_when_it_happened() -> None:
    curve_m = (0.05, 0.06, 0.3, 0.46, 0.5, 0.5)
    recovery = summary("recovery", curve_m, worlds=("limp-pair",))
    learner = entry(recovery, "q-learning", "limp-pair")

    assert learner["steps"] == 100
    assert learner["curve"]["steps"] == [0, 1, 25, 50, 100, 150]
    assert learner["earned"]["iqm_m"] == pytest.approx(curve_m)
    assert learner["until_greedy"]["of"] == 0.9
    assert learner["until_greedy"]["median_steps"] == 50


@pytest.mark.parametrize(("experiment", "share"), [("league", "95"), ("bodies", "90")])
def test_steps_are_counted_to_a_share(
    page: Page, tmp_path: Path, experiment: str, share: str
) -> None:
    comparison = summary(experiment, (0.1, 0.46), steps=(50,), agents=("q-learning",))
    learners = [entry for entry in comparison["worlds"] if entry["role"] == "learner"]
    assert {entry["until_greedy"]["of"] for entry in learners} == {int(share) / 100}
    # 0.4615 m is 92 % of greedy's 0.5015 m.
    median = {"95": None, "90": 50}[share]
    assert {entry["until_greedy"]["median_steps"] for entry in learners} == {median}
    opened(page, tmp_path, comparison)
    assert f"Steps to {share} % of greedy" in text_of(page)


def test_half_grown_league_has_what_its_trials_show() -> None:
    config = experiment_config("league", {"seeds": 2, "gaits": (LRO,), "worlds": ("ice",)})
    assert summarise(config, {})["worlds"] == []
    (first, *_) = Plan(config).trials()
    (entry_of_greedy,) = summarise(config, {first.key: TrialResult(distances_m=(0.4,))})["worlds"]
    assert (
        entry_of_greedy["agent"],
        entry_of_greedy["n"],
        entry_of_greedy["greedy_nominal_m"],
    ) == ("greedy", 1, None)


@pytest.mark.parametrize("experiment", ["league", "recovery"])
def test_report_shows_each_world_with_its_references(
    page: Page, tmp_path: Path, experiment: str
) -> None:
    steps = {"steps": (50,)} if experiment == "league" else {}
    curve_m = (0.1, 0.5) if experiment == "league" else (0.1, 0.2, 0.3, 0.4, 0.5, 0.5)
    worlds = ("limp-pair", "slope:degrees=4")
    opened(page, tmp_path, summary(experiment, curve_m, worlds=worlds, **steps))
    text = text_of(page)

    assert "Two limp legs: metres" in text
    assert "Best known" in text
    assert "Greedy, nominal model" in text
    assert "Greedy, true model" in text
    assert "within 3 % of its design" in text
    assert ("Earned: the sum of the rewards" in text) == (experiment == "recovery")
    for window in ("1 – 50", "51 – 100", "101 – 150", "151 – 200"):
        assert (f"Earned in {window}" in text) == (experiment == "recovery")
    page.get_by_role("button", name="Slope").click()
    assert "4°" in text_of(page)
