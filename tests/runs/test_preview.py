"""Preview of a walking problem before anything runs."""

import re
from typing import Any

import pytest

from hexapods.domain.gait import GaitSpec
from hexapods.domain.robot import PRESETS, robot
from hexapods.runs.config import WalkingProblem
from hexapods.runs.preview import Preview, preview


def preview_of(gait: str | GaitSpec, written: Any = "stiff", **settings: Any) -> Preview:
    return preview(WalkingProblem(gait=gait, robot=robot(written), **settings))


def test_pairs_and_tripod_of_the_hexapod() -> None:
    pairs, tripod = preview_of("left-right-origin"), preview_of("tripod")

    assert (pairs.states, pairs.actions, pairs.values) == (125, 12, 1500)
    assert (tripod.states, tripod.actions, tripod.values) == (25, 8, 200)
    assert pairs.law_m == pytest.approx(0.5)
    assert tripod.law_m == pytest.approx(2 / 3)
    assert not pairs.tips
    assert tripod.better is None
    assert tripod.gait == GaitSpec(1, 2, groups=((1, 3, 5), (2, 4, 6)))
    assert [group.legs for group in tripod.groups] == [[1, 3, 5], [2, 4, 6]]
    assert [leg.side for leg in tripod.legs] == [1, -1, -1, -1, 1, 1]
    assert tripod.mass_kg == pytest.approx(1.2 + 6 * 0.16)


@pytest.mark.parametrize(
    ("written", "gait", "law_m"),
    [
        ({"n_legs": 7}, GaitSpec(1, 2, groups=((1, 3, 5, 7), (2, 4, 6))), 0.662),
        ({"n_legs": 5}, "left-right-vertical", 0.490),
        ({"n_legs": 5}, GaitSpec(1, 2, groups=((1, 3), (2, 4, 5))), 0.658),
        ({"n_legs": 6}, "bound", 0.643),
    ],
)
def test_the_law_counts_each_group_by_its_share_of_the_feet(
    written: dict[str, int], gait: str | GaitSpec, law_m: float
) -> None:
    assert preview_of(gait, written).law_m == pytest.approx(law_m, abs=5e-4)


def test_the_links_of_a_standing_robot_end_at_home_on_the_ground() -> None:
    previewed = preview_of("tripod", "ant")

    for leg in previewed.legs:
        assert leg.links_m is not None
        assert len(leg.links_m) == 4
        *place, height_m = leg.links_m[-1]
        assert place == pytest.approx(leg.home_m)
        assert height_m == pytest.approx(-PRESETS["ant"].body_height_m)
    short = preview_of("tripod", {"tibia_m": 0.01})
    assert [leg.links_m for leg in short.legs] == [None] * 6


def test_a_robot_that_tips_is_offered_other_groups() -> None:
    pace = preview_of("pace")

    assert pace.tips
    assert pace.margin_m == pytest.approx(-0.125)
    assert pace.better is not None
    assert pace.better.gait == GaitSpec(1, 2, groups=((1, 3, 5), (2, 4, 6)))
    assert pace.better.margin_m == pytest.approx(0.125)
    assert pace.better.states == 25
    assert not preview_of(pace.better.gait).tips


@pytest.mark.parametrize(
    ("gait", "written", "agent", "because"),
    [
        ("left-right-origin", "stiff", "linear-model", "stands .* 125.mm"),
        ("tripod", "ant", "linear-model", "stands"),
        ("trot", "dog", "linear-model", r"\(support margin 0.mm\)"),
        ("bound", "stiff", "multilevel-model", "tips .* −"),
        ("one-by-one", {"n_legs": 3}, "multilevel-model", "which group moved"),
    ],
)
def test_a_learner_is_recommended_by_the_support_margin(
    gait: str, written: Any, agent: str, because: str
) -> None:
    previewed = preview_of(gait, written)

    assert previewed.recommended_agent == agent
    assert previewed.tips == (agent == "multilevel-model")
    assert re.search(because, previewed.recommended_because)


def test_a_recommended_learner_takes_the_problem() -> None:
    """A body that tips, with too many pairs to plan for, is left to one that does not plan."""
    previewed = preview_of("one-by-one", {"n_legs": 3}, divisions=6)

    assert previewed.tips
    assert previewed.recommended_agent == "linear-model"
    assert "too many" in previewed.recommended_because


def test_where_no_groups_help_none_are_offered() -> None:
    three = preview_of("one-by-one", {"n_legs": 3})

    assert three.tips
    assert three.stands
    assert three.better is None


def test_a_table_that_does_not_fit_is_previewed_with_its_states() -> None:
    single = preview_of("one-by-one", "centipede")

    assert single.states == 5**12
    assert not single.table_fits


def test_reach_is_given_by_group_where_feet_may_not_go_everywhere() -> None:
    near, far = (
        preview_of("one-by-one", grid_side_m=0.02),
        preview_of("one-by-one", grid_side_m=0.06),
    )

    assert near.groups[0].ahead_m is None
    assert far.groups[0].ahead_m is not None
    assert far.groups[0].ahead_m > 0.03
    assert (near.safe_side_m, near.largest_side_m) == (far.safe_side_m, far.largest_side_m)
    assert near.safe_side_m == 0.035
    assert near.largest_side_m == 0.125


def test_a_grid_out_of_reach_names_the_leg() -> None:
    out = preview_of("tripod", grid_side_m=0.3)

    assert out.out_of_reach is not None
    assert out.out_of_reach.startswith("leg 1 cannot reach cell 1 (front left)")
    assert out.legs[0].out_of_reach == out.out_of_reach
    assert out.legs[3].out_of_reach is not None
    assert out.legs[3].out_of_reach.startswith("leg 4 cannot reach cell")


def test_only_the_leg_that_does_not_reach_is_marked() -> None:
    legs = [{"azimuth_deg": 60.0 * n, "radius_m": 0.1} for n in range(6)]
    short = preview_of("tripod", {"legs": [*legs[:2], {**legs[2], "tibia_m": 0.02}, *legs[3:]]})

    assert [leg.leg for leg in short.legs if leg.out_of_reach] == [3]
    assert short.out_of_reach == short.legs[2].out_of_reach


@pytest.mark.test
@pytest.mark.parametrize("name", PRESETS)
def test_a_body_written_out_is_the_same_robot(name: str) -> None:
    previewed = preview_of("one-by-one", name)
    numbers = {field: value for field, value in previewed.built.items() if value is not None}
    again = preview_of("one-by-one", {**numbers, "legs": [leg.built for leg in previewed.legs]})

    assert again.forward_deg == pytest.approx(previewed.forward_deg)
    assert again.mass_kg == pytest.approx(previewed.mass_kg)
    for leg, same_leg in zip(again.legs, previewed.legs, strict=True):
        assert leg.home_m == pytest.approx(same_leg.home_m)
        assert leg.built == pytest.approx(same_leg.built)
