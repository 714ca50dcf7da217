"""The narrative: its numbers come from the results, and it states nothing they do not support."""

import re
from collections.abc import Callable, Sequence

import pytest

from hexapods.domain.observation import OBSERVATIONS
from hexapods.experiments.plan import TrialSetting
from tests.experiments.sample_experiments import ROBOTS, alpha_of, around, summary_of

ODD_GAIT = "left-right-vertical"


def text_under(summary: dict[str, list[dict[str, str]]], heading: str) -> str:
    """Return the text under a heading, with no-break spaces replaced."""
    text = next(section["text"] for section in summary["story"] if section["heading"] == heading)
    return text.replace("\xa0", " ")


def headings(summary: dict[str, list[dict[str, str]]]) -> Sequence[str]:
    return [section["heading"] for section in summary["story"]]


def test_the_seeds_spread_and_wrong_winners_are_described() -> None:
    """Greedy is at 0.36 m at time-out; of ten seeds nine are ahead."""
    summary = summary_of(
        "table1",
        lambda _: lambda n: 0.31 + 0.06 * min(n, 1) + 0.01 * n,
        seeds=10,
        robots=ROBOTS[:1],
    )
    text = text_under(summary, "One seed misleads")
    assert "of 10 seeds the worst covers 0.31 m and the best 0.46 m" in text
    assert "In 16 of 16 settings" in text
    assert "one seed alone would name the wrong one in 10 % of cases" in text


def test_the_observation_closer_to_the_printed_numbers_is_named() -> None:
    printed = {500: 0.16, 1000: 0.28}  # the printed numbers' averages

    def far(setting: TrialSetting) -> Callable[[int], float]:
        near = setting.training.observation == "commanded"
        return around(printed[setting.training.steps] if near else 0.49)

    summary = summary_of("table1", far, seeds=10, robots=ROBOTS[:1])
    text = text_under(summary, "Two readings of the same robot")
    assert "are nearer to those with commands remembered" in text
    assert "0 of the 8 printed distances lie within the central 95 % of the seeds with feet" in text


def test_only_the_papers_two_observations_are_compared_with_it() -> None:
    config = {"robots": ROBOTS[:1], "observations": OBSERVATIONS}
    summary = summary_of("table1", lambda _: around(0.3, 0.1), seeds=10, **config)
    text = text_under(summary, "Two readings of the same robot")
    assert "feet measured" in text
    assert "feet as planned" not in text


def test_equal_observations_leave_the_closer_one_not_established() -> None:
    summary = summary_of("table1", lambda _: around(0.3, 0.1), seeds=10, robots=ROBOTS[:1])
    text = text_under(summary, "Two readings of the same robot")
    assert "nearer to the printed numbers is not established" in text


def test_the_odd_gait_is_explained_only_on_mujoco() -> None:
    def far(setting: TrialSetting) -> Callable[[int], float]:
        return around(0.15 if setting.gait == ODD_GAIT and setting.robot == "compliant" else 0.4)

    heading = "Why Left-right, mirrored (LeftRight-Vertical) is the odd one"
    assert heading not in headings(summary_of("table1", far, seeds=6))
    text = text_under(summary_of("table1", far, seeds=6, simulator="mujoco"), heading)
    stiff, compliant = (
        next(line for line in text.split("\n") if f"measured ({name} robot)" in line)
        for name in ("stiff", "compliant")
    )
    assert "covers 100 %" in stiff
    assert "covers 37 %" in compliant or "covers 38 %" in compliant
    assert "softer servos alone" not in text  # because greedy is not slow in it here


def test_the_clocks_are_compared_with_times_measured_on_this_machine() -> None:
    text = text_under(summary_of("table1", lambda _: around(0.3), seeds=3), "Whose clock?")
    assert "greedy then ends after 22 s and two-step after 91 s" in text
    assert "greedy thought 0.9 s and two-step 8 s" in text
    assert "ahead at time-out in 0 of 16 timed races" in text


def test_the_caution_names_few_seeds_missing_trials_and_the_simulator() -> None:
    text = text_under(summary_of("figure4", lambda _: around(0.3), seeds=3), "Uncertainty")
    assert "3 seeds a setting is few" in text
    assert "kinematic simulator" in text
    assert "missing" not in text


def test_a_sweep_names_its_best_and_worst() -> None:
    summary = summary_of(
        "sweep",
        lambda setting: around({0.1: 0.1, 0.3: 0.3, 0.6: 0.4}[alpha_of(setting)], 0.001),
        seeds=5,
        alpha=(0.1, 0.3, 0.6),
    )
    text = text_under(summary, "Best and worst")
    assert "The best is α 0.6 with feet measured: 80 % (80 to 80)" in text
    assert "The worst is α 0.1" in text


def test_a_sweep_of_learners_names_what_varies_for_each_and_not_what_only_some_have() -> None:
    far = {"q-learning": 0.1, "sarsa-lambda": 0.2, "r-max": 0.4}
    summary = summary_of(
        "sweep",
        lambda setting: around(far[setting.training.agent], 0.001),
        seeds=5,
        agents=tuple(far),
        steps=(250, 500),
    )
    text = text_under(summary, "Best and worst")
    assert re.search("The best is R-max, (250|500) steps with feet measured", text)
    assert re.search("The worst is Q-learning, (250|500) steps with", text)


@pytest.mark.parametrize("experiment", ["table1", "figure4", "sweep"])
def test_an_experiment_without_trials_has_no_narrative(experiment: str) -> None:
    from hexapods.experiments.summary import summarise
    from tests.experiments.sample_experiments import config

    assert summarise(config(experiment), {})["story"] == []
