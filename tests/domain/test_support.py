"""Static stability, against polygons that can be drawn on paper."""

import pytest

from hexapods.domain.creatures import CREATURES
from hexapods.domain.gait import GaitSpec, Group, resolve
from hexapods.domain.robot import Robot, robot
from hexapods.domain.support import Point, Support, margin_m

SQUARE = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)]


@pytest.mark.parametrize(
    ("center", "feet", "margin"),
    [
        ((0.0, 0.0), SQUARE, 1.0),
        ((0.5, 0.0), [*SQUARE, (0.0, 0.0)], 0.5),
        ((1.0, 0.0), SQUARE, 0.0),
        ((3.0, 0.0), SQUARE, -2.0),
        ((4.0, 5.0), SQUARE, -5.0),
        ((0.0, 0.0), [(1.0, 1.0), (-1.0, -1.0)], 0.0),
        ((0.0, 1.0), [(1.0, 0.0), (-1.0, 0.0), (0.0, 0.0)], -1.0),
        ((0.0, 3.0), [(0.0, 0.0)], -3.0),
    ],
)
def test_the_margin_is_the_distance_to_the_hulls_edge(
    center: Point, feet: list[Point], margin: float
) -> None:
    assert margin_m(center, feet) == pytest.approx(margin)


@pytest.mark.parametrize(
    ("body", "gait", "margin"),
    [
        (Robot(), "left-right-origin", 0.125),
        (Robot(), "left-right-vertical", 0.0),
        (Robot(), "tripod", 0.125),
        (Robot(), "pace", -0.125),
        (robot({"n_legs": 4}), "trot", 0.0),
        (robot({"n_legs": 4}), "left-right-vertical", -0.1768),
        (robot({"n_legs": 3}), "one-by-one", -0.125),
        (CREATURES["starfish"].robot, CREATURES["starfish"].gait, 0.0773),
        (CREATURES["dog"].robot, "trot", 0.0),
        (CREATURES["dog"].robot, "pace", -0.1728),
    ],
)
def test_the_least_margin_tells_which_bodies_tip(
    body: Robot, gait: str | GaitSpec, margin: float
) -> None:
    resolved = resolve(gait, body.azimuths_deg)
    least = Support(body, resolved).least_margin_m(resolved.groups)
    assert least == pytest.approx(margin, abs=1e-4)


@pytest.mark.parametrize(
    ("body", "groups"),
    [
        (Robot(), ((1, 3, 5), (2, 4, 6))),
        (robot({"n_legs": 4}), ((1, 3), (2, 4))),
        (robot({"n_legs": 5}), ((1, 3), (2, 4), (5,))),
        (robot({"n_legs": 3}), ((1,), (2,), (3,))),
        (CREATURES["centipede"].robot, ((1, 3, 5, 7, 9, 11), (2, 4, 6, 8, 10, 12))),
    ],
)
def test_the_fewest_groups_that_stand_are_found(body: Robot, groups: tuple[Group, ...]) -> None:
    support = Support(body, resolve("one-by-one", body.azimuths_deg))
    assert support.steadiest_groups() == groups


def test_the_legs_own_masses_move_the_centre_of_mass() -> None:
    """A kilogram more in the coxa of leg 1 counts halfway between its mount and its foot."""
    legs = [{"azimuth_deg": a} for a in (0, 60, 120, 180, 240, 300)]
    heavy = robot({"legs": [{**legs[0], "coxa_kg": 1.06}, *legs[1:]]})
    gait = resolve(GaitSpec(6, 2, "origin"), heavy.azimuths_deg)  # forward along leg 1

    total_kg = 1.2 + 6 * 0.16 + 1
    assert Support(heavy, gait).center_m == pytest.approx((0, 0.175 / total_kg))
