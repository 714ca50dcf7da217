"""Inverse and forward kinematics of the legs, and the check of reach."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from hexapods.domain.errors import Unreachable
from hexapods.domain.feet import StepLaw
from hexapods.domain.gait import PAPER_GAITS, resolve
from hexapods.domain.grid import FootGrid
from hexapods.domain.kinematics import JOINT_LIMITS_RAD, check_reach, legs_of
from hexapods.domain.legs import FootKinematics
from hexapods.domain.motion import StepMotion
from hexapods.domain.observation import legal_actions
from hexapods.domain.robot import PRESETS, Robot, robot
from hexapods.domain.types import FloatArray


def kinematics(body: Robot, gait: str = "left-right-origin") -> FootKinematics:
    return legs_of(body).under(resolve(gait, body.azimuths_deg))


def offsets(legs: int) -> st.SearchStrategy[FloatArray]:
    """Foot offsets from home that every leg of the default robot reaches, (legs, 3) [m]."""
    shares = arrays(float, (legs, 3), elements=st.floats(0, 1))
    return shares.map(lambda s: s * (0.08, 0.08, 0.05) - (0.04, 0.04, 0.01))


@given(st.sampled_from(sorted(PAPER_GAITS)), offsets(6))
def test_forward_kinematics_inverts_inverse_kinematics(gait: str, places: FloatArray) -> None:
    legs = kinematics(Robot(), gait)
    angles = legs.joint_angles(places)

    assert angles.shape == (18,)
    assert np.allclose(legs.foot_offsets(angles.tolist()), places, atol=1e-12)


def test_links_lead_from_the_mounts_by_their_lengths_to_the_feet() -> None:
    ant = PRESETS["ant"]
    legs = legs_of(ant)
    gait = resolve("tripod", ant.azimuths_deg)
    angles = legs.under(gait).joint_angles(np.zeros((6, 3)))
    feet = legs.feet_in_body(angles[None])[0]

    for leg, (mount, places) in enumerate(
        zip(ant.legs, legs.links_in_body(angles.tolist()), strict=True)
    ):
        x, y, z = places[0]
        assert math.hypot(x, y) == pytest.approx(mount.radius_m)
        assert z == mount.z_m
        lengths_m = np.linalg.norm(np.diff(places, axis=0), axis=1)
        wanted = [ant.of_legs(name)[leg] for name in ("coxa_m", "femur_m", "tibia_m")]
        assert lengths_m == pytest.approx(wanted)
        assert places[-1] == pytest.approx(feet[leg], abs=1e-12)


@given(offsets(8))
def test_forward_kinematics_inverts_inverse_kinematics_for_other_proportions(
    places: FloatArray,
) -> None:
    legs = kinematics(robot({"n_legs": 8, "coxa_m": 0.03, "femur_m": 0.1, "body_height_m": 0.08}))
    angles = legs.joint_angles(places)

    assert np.allclose(legs.foot_offsets(angles.tolist()), places, atol=1e-12)


def test_at_home_all_legs_have_equal_angles_with_the_knee_above() -> None:
    angles = kinematics(Robot()).joint_angles(np.zeros((6, 3)))
    coxa, femur, tibia = angles.reshape(6, 3).T

    assert np.allclose(coxa, 0, atol=1e-15)
    assert np.ptp(femur) < 1e-12
    assert np.ptp(tibia) < 1e-12
    # The two-link arm spans 0.10 m out and 0.09 m down.
    assert np.allclose(0.08 * np.cos(femur) + 0.13 * np.cos(femur + tibia), 0.10)
    assert np.allclose(0.08 * np.sin(femur) + 0.13 * np.sin(femur + tibia), -0.09)
    assert (femur > 0).all()


def test_a_leg_that_points_forward_stretches_to_reach_forward() -> None:
    """Front-back: leg 2 points forward, leg 5 backward; neither coxa turns."""
    angles = kinematics(Robot(), "front-back-origin").joint_angles(np.tile((0, 0.02, 0), (6, 1)))
    home = kinematics(Robot()).joint_angles(np.zeros((6, 3)))

    assert angles[[3, 12]] == pytest.approx(0, abs=1e-12)
    assert angles[5] > home[5]
    assert angles[14] < home[14]


def test_a_leg_on_the_left_swings_clockwise_to_reach_forward() -> None:
    """Left-right: leg 3 points left, leg 6 right."""
    angles = kinematics(Robot()).joint_angles(np.tile((0, 0.02, 0), (6, 1)))

    assert angles[6] == pytest.approx(-np.arctan2(0.02, 0.15))
    assert angles[15] == pytest.approx(np.arctan2(0.02, 0.15))


def test_joint_angles_out_of_reach_are_nan() -> None:
    angles = kinematics(Robot()).joint_angles(np.tile((0, 0.3, 0), (6, 1)))

    assert np.isnan(angles).any()


@pytest.mark.parametrize("gait", PAPER_GAITS)
@pytest.mark.parametrize("legs", [4, 6, 8, 10])
def test_the_default_grid_is_within_reach_of_four_to_ten_legs(gait: str, legs: int) -> None:
    body = robot({"n_legs": legs})
    resolved = resolve(gait, body.azimuths_deg)
    check_reach(body, resolved, FootGrid())

    # For every possible offset all joint angles stay within their limits.
    places = np.array([(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (0, 1)])
    drift = len(resolved.groups) - 1
    scaled = places * (0.02, drift * 0.02, body.step_height_m)
    angles = legs_of(body).under(resolved).joint_angles(np.repeat(scaled[:, None], legs, axis=1))
    for joint, (low, high) in enumerate(JOINT_LIMITS_RAD.values()):
        assert (angles[..., joint::3] > low).all()
        assert (angles[..., joint::3] < high).all()


@pytest.mark.parametrize(
    ("written", "side_m", "message"),
    [
        ({}, 0.3, r"leg 1 cannot reach cell 1 \(front left\)"),
        ({"tibia_m": 0.05}, 0.04, r"leg 1 cannot reach cell 0 \(home\): it is out of the reach"),
        ({"step_height_m": 0.1}, 0.04, r"leg 5 cannot reach cell 1 \(front left\): its femur"),
        ({"body_height_m": 0.2}, 0.04, r"leg 1 cannot reach cell 0 \(home\): it is out"),
        ({"n_legs": 12}, 0.15, r"leg 2 cannot reach cell 1 \(front left\)"),
    ],
)
def test_a_grid_that_a_leg_cannot_reach_names_leg_and_cell(
    written: dict[str, Any], side_m: float, message: str
) -> None:
    body = robot(written)
    with pytest.raises(Unreachable, match=message + r".*; choose a smaller grid_side_m than"):
        check_reach(body, resolve("left-right-origin", body.azimuths_deg), FootGrid(side_m=side_m))


def test_a_joint_beyond_its_limit_is_named() -> None:
    body = robot({"home_radius_m": 0.2, "body_height_m": 0.06})
    with pytest.raises(Unreachable, match="its tibia would turn to -163°, beyond its limit"):
        check_reach(body, resolve("left-right-origin", body.azimuths_deg), FootGrid())


def test_positions_between_two_cells_must_be_within_reach_too() -> None:
    """Between front left and back left the foot of a left leg passes closest to its coxa joint."""
    body = robot({"n_legs": 4, "step_height_m": 0.07})
    with pytest.raises(Unreachable, match="on the way there: its femur would turn to"):
        check_reach(body, resolve("front-back-origin", body.azimuths_deg), FootGrid(side_m=0.08))


@pytest.mark.parametrize(
    ("written", "gait", "side_m"),
    [
        ({}, "left-right-origin", 0.1),
        ({"n_legs": 12}, "left-right-origin", 0.04),
        ({}, "one-by-one", 0.06),
        ({"n_legs": 5}, "left-right-vertical", 0.07),
    ],
)
def test_where_feet_could_drift_out_of_reach_the_reach_is_returned(
    written: dict[str, Any], gait: str, side_m: float
) -> None:
    """It is at least the grid, and within it every leg follows every step."""
    body = robot(written)
    resolved, grid = resolve(gait, body.azimuths_deg), FootGrid(side_m=side_m)
    reach = check_reach(body, resolved, grid)

    assert reach is not None
    assert max(reach.back_m) <= -side_m / 2
    assert min(reach.ahead_m) >= side_m / 2
    law, rng = StepLaw(resolved, grid, reach), np.random.default_rng(0)
    motion, feet, plans = StepMotion(body, resolved, law), law.at_home(), []
    for _ in range(300):
        legal = law.possible(feet, legal_actions(feet.commanded, len(grid)))
        plans.append(motion.plan(feet, legal[int(rng.integers(len(legal)))]))
        feet = plans[-1].end
        assert feet.mean_m(resolved.sizes) == pytest.approx(0, abs=1e-12)
    targets = motion.joint_targets(plans)
    low, high = legs_of(body).limits_rad
    assert ((low <= targets) & (targets <= high)).all()
