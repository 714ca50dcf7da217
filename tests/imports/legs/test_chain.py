import numpy as np
import pytest

from hexapods.imports.legs.chain import PRECISION, LegChain


@pytest.fixture
def leg() -> LegChain:
    """Return a leg of a hexapod that stretches along x: coxa, femur and tibia."""
    return LegChain(
        np.array([[0.0, 0, 1], [0, 1, 0], [0, 1, 0]]),
        np.array([[0.1, 0, 0], [0.15, 0, 0], [0.23, 0, 0]]),
        np.array([0.36, 0, 0]),
        np.array([[-1.0, -1.5, -0.2], [1.0, 1.5, 2.5]]),
    )


def test_its_foot_goes_where_its_joints_turn_it(leg: LegChain) -> None:
    angles = np.array([[0, 0, 0], [np.pi / 2, 0, 0], [0, 0, np.pi / 2]])

    feet = leg.feet(angles)

    assert leg.length_m == pytest.approx(0.26)
    assert feet == pytest.approx(np.array([[0.36, 0, 0], [0.1, 0.26, 0], [0.23, 0, -0.13]]))


def test_its_derivatives_are_those_of_its_foot(leg: LegChain) -> None:
    angles = np.array([[0.2, -0.3, 1.0]])
    small = np.array([1e-4, -2e-4, 3e-4])

    moved = leg.feet(angles + small) - leg.feet(angles)

    assert leg.jacobians(angles)[0] @ small == pytest.approx(moved[0], abs=1e-7)


def test_slopes_are_the_same_derivatives(leg: LegChain) -> None:
    angles = np.random.default_rng(0).uniform(-1, 1, (20, 3))

    assert leg.slopes(angles) == pytest.approx(leg.jacobians(angles), abs=1e-9)


def test_angles_are_found_again(leg: LegChain) -> None:
    rng = np.random.default_rng(0)
    start = np.array([0.0, -0.4, 1.4])
    targets = leg.feet(start + rng.uniform(-0.3, 0.3, (50, 3)))

    angles, off = leg.solve(targets, start)

    assert off.max() < 1e-6
    assert leg.feet(angles) == pytest.approx(targets, abs=1e-6)
    low, high = leg.limits
    assert ((angles >= low) & (angles <= high)).all()


def test_a_point_out_of_reach_has_a_finite_solution_with_its_error(leg: LegChain) -> None:
    angles, off = leg.solve(np.array([[0.5, 0, 0], [0.2, 0, 0.3]]), np.array([0.0, -0.4, 1.4]))

    assert (off > PRECISION * leg.length_m).all()
    assert np.isfinite(angles).all()
