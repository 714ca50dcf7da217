"""The finding: one sentence by the intervals, and none where nothing can be compared."""

from collections.abc import Callable
from typing import Any

import pytest

from hexapods.experiments.plan import TrialSetting
from hexapods.experiments.presets import PRESETS
from hexapods.experiments.summary import summarise
from tests.experiments.sample_experiments import alpha_of, around, config, summary_of


def finding_of(
    experiment: str, far: Callable[[TrialSetting], Callable[[int], float]], **options: Any
) -> str:
    """Return the finding, with no-break spaces replaced."""
    finding: str = summary_of(experiment, far, **options)["finding"]
    return finding.replace("\xa0", " ")


def by_alpha(
    *distances_m: float, spread_m: float
) -> Callable[[TrialSetting], Callable[[int], float]]:
    distance_of_alpha = dict(zip((0.1, 0.3, 0.6), distances_m, strict=False))
    return lambda setting: around(distance_of_alpha[alpha_of(setting)], spread_m)


def test_a_combination_that_is_clearly_ahead_walks_farthest() -> None:
    far = by_alpha(0.1, 0.3, 0.4, spread_m=0.001)
    finding = finding_of("sweep", far, seeds=5, alpha=(0.1, 0.3, 0.6))
    assert finding == "α 0.6 walks farthest: 80 % (80 to 80) of greedy's distance."


@pytest.mark.parametrize(
    ("distances_m", "ending"),
    [
        ((0.1, 0.39, 0.4), "1 of the 2 others may be as good."),
        ((0.38, 0.39, 0.4), "each of the 2 others may be as good."),
        ((0.39, 0.4), "the other may be as good."),
    ],
)
def test_what_may_be_as_good_is_counted(distances_m: tuple[float, ...], ending: str) -> None:
    alpha = (0.1, 0.3, 0.6)[: len(distances_m)]
    finding = finding_of("sweep", by_alpha(*distances_m, spread_m=0.1), seeds=5, alpha=alpha)
    assert finding.startswith(f"α {alpha[-1]:g} leads with ")
    assert finding.endswith(f"of greedy's distance; {ending}")


def test_one_setting_and_few_seeds_find_nothing() -> None:
    assert finding_of("sweep", lambda _: around(0.3), seeds=5) == ""
    one_seed = finding_of("sweep", by_alpha(0.1, 0.3, spread_m=0.0), seeds=1, alpha=(0.1, 0.3))
    assert one_seed == "α 0.3 leads with 60 % of greedy's distance; so few seeds tell little."


LEAGUE: dict[str, Any] = {
    "agents": ("q-learning", "linear-model"),
    "worlds": ("flat", "noise"),
    "seeds": 3,
    "gaits": ("left-right-origin",),
}


def test_the_farthest_learner_of_a_league_is_named_by_its_worlds() -> None:
    def far(setting: TrialSetting) -> Callable[[int], float]:
        is_model = setting.training.agent == "linear-model"
        return around(0.4 if is_model and "/noise/" not in setting.key else 0.2, 0.0)

    assert (
        finding_of("league", far, **LEAGUE)
        == "Of 2 learners Linear model walks farthest in 1 of 2 worlds."
    )
    two_gaits = LEAGUE | {"gaits": ("left-right-origin", "left-right-vertical")}
    ahead = finding_of(
        "league",
        lambda setting: around(0.4 if setting.training.agent == "linear-model" else 0.2),
        **two_gaits,
    )
    assert (
        ahead
        == "Of 2 learners Linear model walks farthest in all 4 combinations of gait and world."
    )
    assert finding_of("league", lambda _: around(0.3), **LEAGUE) == ""


def test_the_only_learner_is_measured_by_greedy() -> None:
    alone = LEAGUE | {"agents": ("q-learning",)}
    assert (
        finding_of("league", lambda _: around(0.25, 0.0), **alone)
        == "Q-learning walks 50 % of greedy's distance."
    )
    noisy = finding_of(
        "league", lambda setting: around(0.4 if "/noise/" in setting.key else 0.2, 0.0), **alone
    )
    assert noisy == (
        "Q-learning walks 80 % of greedy's distance with Sensor noise, and 40 % with the other."
    )


@pytest.mark.parametrize("experiment", [*PRESETS])
def test_without_trials_nothing_is_found(experiment: str) -> None:
    assert summarise(config(experiment), {})["finding"] == ""
