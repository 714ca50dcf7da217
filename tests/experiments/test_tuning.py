"""A tuning: the same command gives the same study, and what it finds is judged on other seeds."""

import csv
import io
import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import Annotated, Any

import pytest
from annotated_types import Gt, Le

from hexapods.domain.errors import HexapodError
from hexapods.domain.records import from_json, to_json
from hexapods.domain.settings import Setting, declare
from hexapods.experiments.config import experiment_config
from hexapods.experiments.folder import open_results
from hexapods.experiments.plan import Plan, Trial
from hexapods.experiments.progress import Progress
from hexapods.experiments.trial import TrialResult, run_trial
from hexapods.experiments.tuning.config import TuningConfig, config_json, tuning_config
from hexapods.experiments.tuning.ranges import SearchRange, declared_range, parse_range
from hexapods.experiments.tuning.report import command, tuning_files
from hexapods.experiments.tuning.study import Study
from hexapods.experiments.tuning.summary import summarise_tuning
from hexapods.experiments.tuning.tuning import BATCH, NothingTried, Run, Tuning, search_seeds
from hexapods.experiments.worker import Outcome
from hexapods.runs.config import agent_settings

pytestmark = pytest.mark.test

LRO = "left-right-origin"
MOODY = "tests.own_agents:Moody"
"""An agent of which one setting makes all the difference."""
Walk = Callable[[Trial], TrialResult]


def config(agent: str = "q-learning", **given: Any) -> TuningConfig:
    """Return a tuning of kinematic trials that take milliseconds each."""
    usual = {
        "gaits": (LRO,),
        "simulator": "kinematic",
        "steps": (30,),
        "candidates": 2 * BATCH + 1,
        "search_seeds": 2,
        "seeds": 5,
    }
    return tuning_config(agent, **{**usual, **given})


def one_by_one(progress: Progress, walk: Walk = lambda trial: run_trial(trial.config)) -> Run:
    """Run trials in this process, without a cluster."""

    def run(trials: Sequence[Trial]) -> Iterator[Outcome]:
        for trial in trials:
            outcome = Outcome(trial.key, walk(trial), None, 0.1)
            progress.add(outcome)
            yield outcome

    return run


def tuned(
    given: TuningConfig, walk: Walk = lambda trial: run_trial(trial.config)
) -> tuple[Tuning, Progress]:
    """Run a tuning to its end."""
    tuning, progress = Tuning(given), Progress(given)
    list(tuning.run(progress, one_by_one(progress, walk)))
    assert tuning.is_complete
    return tuning, progress


def walking(far_m: Callable[[float, bool], float]) -> Walk:
    """Return made-up walks, by the learning rate and whether the trial is one of the search."""

    def walk(trial: Trial) -> TrialResult:
        alpha = trial.config.training.settings.get("alpha", 0.3)
        metres = far_m(float(str(alpha)), "/search/" in trial.key) + 0.001 * trial.seed_number
        return TrialResult(distances_m=(metres,) * len(trial.config.evaluations or (0,)))

    return walk


@pytest.mark.parametrize(
    ("agent", "name", "expected", "is_logarithmic"),
    [
        ("q-learning", "alpha", "alpha=0.01:1.0", True),  # a tenth of the lowest example
        ("q-learning", "gamma", "gamma=0.0:0.999", False),  # at a distance from 1
        ("n-step-sarsa", "return_steps", "return_steps=1:100", True),
        ("look-ahead", "depth", "depth=1:50", False),
        ("linear-model", "prior", "prior=none,kinematic", False),
    ],
)
def test_search_ranges_follow_from_the_declarations(
    agent: str, name: str, expected: str, is_logarithmic: bool
) -> None:
    settings = agent_settings(agent)
    found = declared_range(settings[name])

    assert found is not None
    assert (str(found), found.is_logarithmic) == (expected, is_logarithmic)
    assert parse_range(str(found), settings) == found


def test_booleans_are_choices_and_numbers_without_limits_have_no_range() -> None:
    about = Setting(title="Anything", help="Whatever.")

    assert declared_range(declare("fast", Annotated[bool, about], default=False)) == SearchRange(
        name="fast", choices=(False, True)
    )
    assert declared_range(declare("size", Annotated[float, Gt(0), about], default=1.0)) is None
    optional = Annotated[float | None, Gt(0), Le(1), about]
    assert declared_range(declare("rate", optional, default=None)) is None


def test_numbers_are_rounded_within_their_range() -> None:
    narrow = SearchRange(name="gamma", low=0.5, high=0.99996)

    assert narrow.rounded(0.123456) == 0.5
    assert narrow.rounded(0.7123456) == 0.7123
    assert narrow.rounded(0.99996) == 0.99996, "not 1.0, which is out of the range"


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("alpha", "NAME=LOW:HIGH or NAME=VALUE,VALUE"),
        ("alpah=0.1:1", "alpha, gamma"),
        ("alpha=0:1", "alpha must be a number over 0 and at most 1"),
        ("alpha=0.1:2", "at most 1"),
        ("alpha=1:0.1", "alpha=1:0.1: LOW must be below HIGH"),
        ("alpha=0.3:0.3", "LOW must be below HIGH"),
        ("alpha=0.1:0.3:1", "the range of alpha must be LOW:HIGH, not '0.1:0.3:1'"),
        ("alpha=0.5:1", "must contain its default, 0.3"),
        ("alpha=0.3", "two or more different values"),
        ("alpha=0.3,0.3", "two or more different values"),
        ("alpha=many:more", "must be a number"),
    ],
)
def test_invalid_range_is_refused_in_a_sentence(text: str, names: str) -> None:
    with pytest.raises(HexapodError) as refused:
        parse_range(text, agent_settings("q-learning"))
    assert names in str(refused.value)


def test_choices_have_no_ends() -> None:
    with pytest.raises(HexapodError, match="prior is no number; list its values: none, or kin"):
        parse_range("prior=none:kinematic", agent_settings("linear-model"))


@pytest.mark.parametrize(
    ("given", "names"),
    [
        ({"agent": "greedy"}, "greedy does not learn, so there is nothing to tune; choose one of"),
        ({"agent": "skynet"}, "linear-model, greedy"),
        (
            {"agent": "tests.experiments.crashing_agent:CrashingAgent", "settings": ("x",)},
            "setting",
        ),
        ({"settings": ("alpha", "beta")}, "alpha, gamma"),
        ({"settings": ("alpha",), "ranges": ("gamma=0.1:0.9",)}, "not one of the settings to tune"),
        ({"ranges": ("alpha=0.1:1", "alpha=0.2:1")}, "given twice"),
        ({"candidates": 0}, "candidates must be from 1 to 10,000, not 0"),
        ({"search_seeds": 0}, "search_seeds must be from 1"),
        ({"seeds": 0}, "from 1 to 10,000, not 0"),
        (
            {"candidates": 10_000, "search_seeds": 100},
            "the search has 1,000,000 trials, the most is",
        ),
        ({"objective": "speed"}, "distance, area"),
        ({"gaits": (LRO, "front-back-origin")}, "gaits must name one"),
        ({"worlds": ("moon",)}, "limp-pair"),
        (
            {"beside": ("q-learning",)},
            "q-learning is tuned, and walks with its defaults anyway; le",
        ),
        ({"beside": ("r-max", "r-max")}, "--beside names r-max twice"),
    ],
)
def test_invalid_tuning_is_refused_in_a_sentence(given: dict[str, Any], names: str) -> None:
    with pytest.raises(HexapodError) as refused:
        config(**given)
    assert names in str(refused.value)


def test_settings_are_named_as_their_options_too() -> None:
    by_option = config("dyna-q", settings=("planning-steps",), ranges=("planning-steps=1:100",))

    assert by_option == config(
        "dyna-q", settings=("planning_steps",), ranges=("planning_steps=1:100",)
    )
    assert by_option.ranges == ("planning_steps=1:100",)


def test_config_is_read_back_from_plain_types() -> None:
    one = config(ranges=("alpha=0.05:1",), beside=("linear-model",), objective="area")
    assert from_json(TuningConfig, json.loads(json.dumps(to_json(one)))) == one


def test_defaults_are_first_and_the_same_seed_gives_the_same_study() -> None:
    first, others = tuned(config()), tuned(config())
    of_another_seed, _ = tuned(config(seed=1))

    assert first[0].candidates[0].values == {
        name: one.default for name, one in agent_settings("q-learning").items()
    }
    assert first[0].candidates == others[0].candidates
    assert first[1].results == others[1].results
    assert first[0].candidates[1].values != of_another_seed.candidates[1].values


def test_default_is_tried_as_it_is_and_what_follows_is_rounded() -> None:
    study = Study([SearchRange(name="rate", low=0.0, high=1.0)], {"rate": 0.123456}, seed=0)

    assert study.ask() == (0, {"rate": 0.123456})
    number, values = study.ask()
    assert (number, values["rate"]) == (1, float(f"{values['rate']:.4g}"))


def test_order_in_which_trials_end_does_not_change_the_study() -> None:
    given = config()
    expected, _ = tuned(given)
    tuning, progress = Tuning(given), Progress(given)
    run = one_by_one(progress)
    list(tuning.run(progress, lambda trials: run(trials[::-1])))

    assert tuning.candidates == expected.candidates


@pytest.mark.parametrize("ended", [0, 3, 2 * BATCH, 2 * BATCH + 1, 20])
def test_killed_and_started_again_it_goes_on_and_gives_the_same(ended: int, tmp_path: Path) -> None:
    given = config()
    unbroken, everything = tuned(given)
    with open_results(tmp_path / "kept", given) as folder:
        list(islice(Tuning(given).run(folder, one_by_one(folder)), ended))
    with open_results(tmp_path / "kept", given) as folder:
        resumed = Tuning(given)
        again = list(resumed.run(folder, one_by_one(folder)))

        assert len(again) == everything.done - ended, "no trial is run twice"
        assert folder.results == everything.results
    assert (resumed.candidates, resumed.tuned) == (unbroken.candidates, unbroken.tuned)


def test_interrupted_tuning_is_not_complete() -> None:
    given = config()
    tuning, progress = Tuning(given), Progress(given)
    run = one_by_one(progress)

    list(tuning.run(progress, lambda trials: islice(run(trials), 3)))
    assert (tuning.is_complete, tuning.candidates, progress.done) == (False, [], 3)


def test_more_candidates_go_on_from_fewer(tmp_path: Path) -> None:
    few, more = config(candidates=BATCH + 1), config(candidates=2 * BATCH)
    with open_results(tmp_path / "kept", few) as folder:
        list(Tuning(few).run(folder, one_by_one(folder)))
    with open_results(tmp_path / "kept", more) as folder:
        tuning = Tuning(more)
        list(tuning.run(folder, one_by_one(folder)))
    assert tuning.candidates == tuned(more)[0].candidates


def test_held_out_seeds_are_those_of_a_league_and_none_of_the_search() -> None:
    given = config(seeds=100, search_seeds=100)
    league = {"seeds": 100, "gaits": (LRO,), "simulator": "kinematic", "steps": (30,)}
    plan = Plan(experiment_config("league", {**league, "agents": ("q-learning",)}))
    tuning = Tuning(given)
    searched = {trial.config.training.seed for trial in tuning.search_trials(tuning.default_values)}
    held_out = [t.config for t in tuning.plan.trials() if t.setting.role == "learner"]

    assert held_out == [t.config for t in plan.trials() if t.setting.role == "learner"]
    assert len(searched) == len({one.training.seed for one in held_out}) == 100
    assert searched.isdisjoint(one.training.seed for one in held_out)
    assert searched == set(search_seeds(given))


def test_the_better_of_two_values_is_found_and_confirmed() -> None:
    given = config(MOODY, settings=("mood",), steps=(5,), candidates=BATCH)
    tuning, progress = tuned(given)
    summary = summarise_tuning(tuning, progress, None)

    assert tuning.best.values == {"mood": "bright"}
    assert summary["gain"]["distance"]["is_better"] == "yes"
    assert summary["gain"]["distance"]["low"] > 0.1
    assert "On 5 held-out seeds the tuned settings are better" in summary["said"][-1]


@pytest.mark.parametrize(
    ("tuned_m", "said"),
    [
        (0.4, "On 5 held-out seeds the tuned settings are better: distance after the practice gre"),
        (0.1, "On 5 held-out seeds the tuned settings are worse than the defaults"),
        (0.2, "On 5 held-out seeds the tuned settings are not shown to be better than the defaul"),
    ],
)
def test_it_says_plainly_what_the_tuned_settings_are_worth_on_held_out_seeds(
    tuned_m: float, said: str
) -> None:
    def far_m(alpha: float, is_search: bool) -> float:
        if alpha == 0.3:
            return 0.2
        return 0.5 if is_search else tuned_m

    given = config(settings=("alpha",), ranges=("alpha=0.3,0.6",))
    summary = summarise_tuning(*tuned(given, walking(far_m)), workers=1)

    assert (
        "the best is α\u00a00.6. Mean distance after the practice there 0.500 m, with the de"
        in (summary["said"][0])
    )
    assert said in summary["said"][1]
    assert summary["gain"]["distance"]["iqm"] == pytest.approx(tuned_m - 0.2)


def test_it_says_that_nothing_was_better_than_the_defaults() -> None:
    given = config(settings=("alpha",), ranges=("alpha=0.3,0.6",))
    tuning, progress = tuned(given, walking(lambda alpha, _: -alpha))
    summary = summarise_tuning(tuning, progress, workers=1)

    assert tuning.tuned == tuning.defaults
    assert summary["said"][0].endswith("than the defaults. Nothing is tuned.")
    assert summary["gain"]["distance"]["iqm"] == 0


def test_objective_is_the_mean_over_the_seeds_and_a_failed_walk_counts_nothing() -> None:
    def walk(trial: Trial) -> TrialResult:
        if trial.seed_number == 0:
            return TrialResult(failure="it diverged")
        return TrialResult(distances_m=(0.2, 0.4)[-len(trial.config.evaluations or (0,)) :])

    by_distance, _ = tuned(config(candidates=1), walk)
    by_area, _ = tuned(config(candidates=1, objective="area"), walk)

    assert (by_distance.best.value_m, by_distance.best.failed) == (0.4 / 2, 1)
    # evaluated after 25 and 30 steps: (25 · .1 + 5 · .3) / 30 m
    assert by_area.best.value_m == pytest.approx((2.5 + 1.5) / 30 / 2)


def test_values_that_cannot_be_run_are_never_the_best() -> None:
    given = config(settings=("alpha",), ranges=("alpha=0.3,0.6",))
    tuning, progress = Tuning(given), Progress(given)

    def run(trials: Sequence[Trial]) -> Iterable[Outcome]:
        for trial in trials:
            aside = "alpha=0.6" in trial.key
            result = None if aside else TrialResult(distances_m=(0.1,))
            progress.add(Outcome(trial.key, result, "it broke" if aside else None, 0.1))
            yield from ()

    list(tuning.run(progress, run))
    assert tuning.tuned == tuning.defaults
    assert {one.reason for one in tuning.candidates} == {None, "it broke"}


def test_tuning_of_which_nothing_can_be_run_ends_in_a_sentence() -> None:
    given = config()
    tuning, progress = Tuning(given), Progress(given)

    def run(trials: Sequence[Trial]) -> Iterable[Outcome]:
        for trial in trials:
            progress.add(Outcome(trial.key, None, "it broke", 0.1))
        return ()

    with pytest.raises(NothingTried, match="no settings could be tried: it broke"):
        list(tuning.run(progress, run))


def test_values_that_do_not_go_together_are_not_tried() -> None:
    # six legs in three pairs have 4,913 states at four divisions, which a model takes; not at five
    with pytest.raises(HexapodError, match="divisions"):
        Tuning(config("dyna-q", divisions=(5,)))


def test_report_is_the_same_for_the_same_results_and_has_every_trial() -> None:
    given = config(MOODY, settings=("mood", "optimism"), beside=("q-learning",), candidates=BATCH)
    tuning, progress = tuned(given)
    summary = summarise_tuning(tuning, progress, workers=1)
    files = dict(tuning_files(tuning, progress, summary))

    assert files == dict(tuning_files(tuning, progress, summary))
    assert json.loads(files["summary.json"]) == json.loads(json.dumps(summary))
    rows = list(csv.DictReader(io.StringIO(files["trials.csv"].decode(), newline="")))
    # greedy, and the defaults, the tuned and Q-learning on five seeds each
    assert [row["phase"] for row in rows].count("held-out") == 1 + 3 * 5
    assert [row["phase"] for row in rows].count("search") == BATCH * 2
    tried = {row["candidate"] for row in rows if row["phase"] == "search"}
    assert tried == {str(number) for number in range(BATCH)}
    assert summary["config"]["candidates"] == BATCH
    assert (summary["config"]["search_seeds"], summary["config"]["held_out_seeds"]) == (2, 5)
    assert {row["mood"] for row in rows if row["agent"] == MOODY} == {"dull", "bright"}
    page = files["report.html"].decode()
    lead = "4 candidates, each a combination of settings, on 2 seeds, then the best and the def"
    for text in (
        *summary["said"],
        lead,
        "Candidate 1",
        "Moody, tuned",
        "Moody, defaults",
        "Greedy",
    ):
        assert text in page
    assert page.count("<svg") >= 2, "a scatter for each setting"


def test_report_names_the_command_that_made_it() -> None:
    assert command(config_json(config(settings=("alpha",), ranges=("alpha=0.05:1",)))) == (
        "hexapods tune q-learning --gait left-right-origin --simulator kinematic --steps 30 "
        "--candidates 9 --seeds 2 --held-out 5 --seed 0 --range alpha=0.05:1.0 --settings alpha"
    )
    assert command(config_json(config(beside=("linear-model",), divisions=(3,)))).endswith(
        " --divisions 3 --steps 30 --candidates 9 --seeds 2 --held-out 5 --seed 0 "
        "--beside linear-model"
    )
