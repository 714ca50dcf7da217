"""Static stability: distance of the centre of mass from the edge of the support polygon.

A robot stands while its centre of mass is over the support polygon, the convex hull of the feet on
the ground (McGhee and Frank 1968, "On the stability properties of quadruped creeping gaits").
"""

import math
from collections.abc import Iterable, Sequence
from itertools import combinations, pairwise, product
from typing import Self

from hexapods.domain.gait import Gait, Group
from hexapods.domain.kinematics import legs_of
from hexapods.domain.robot import Robot

Point = tuple[float, float]
STANDS_M = -1e-6
"""Least margin with which a robot stands: of two feet it is 0, but for rounding."""
_MAX_LEGS_OF_THREE_GROUPS = 8
"""With more legs there are too many divisions into three groups to try."""


def margin_m(center: Point, feet: Iterable[Point]) -> float:
    """Return how far a point is inside the convex hull of others, below 0 if it is outside [m].

    Args:
        center: the centre of mass, from above.
        feet: the feet that stand, one or more.
    """
    corners = _convex_hull(feet)
    if len(corners) < 3:
        return -_distance(center, corners[0], corners[-1])
    edges = [*pairwise(corners), (corners[-1], corners[0])]
    least = min(_distance(center, start, end) for start, end in edges)
    return least if all(_left_of(start, end, center) >= 0 for start, end in edges) else -least


def _convex_hull(points: Iterable[Point]) -> list[Point]:
    """Return the corners of the hull, anticlockwise (Andrew's monotone chain)."""
    ordered = sorted(set(points))
    if len(ordered) < 3:
        return ordered
    halves = []
    for way in (ordered, ordered[::-1]):
        half: list[Point] = []
        for point in way:
            while len(half) > 1 and _left_of(half[-2], half[-1], point) <= 0:
                half.pop()
            half.append(point)
        halves.append(half[:-1])
    return halves[0] + halves[1]


def _left_of(start: Point, end: Point, point: Point) -> float:
    """Return twice the area of a triangle, above 0 if the point is left of the line."""
    along_x, along_y = end[0] - start[0], end[1] - start[1]
    return along_x * (point[1] - start[1]) - along_y * (point[0] - start[0])


def _distance(point: Point, start: Point, end: Point) -> float:
    """Return the distance of a point from a segment [m]."""
    along = end[0] - start[0], end[1] - start[1]
    to = point[0] - start[0], point[1] - start[1]
    squared = along[0] ** 2 + along[1] ** 2
    share = 0.0 if squared == 0 else (along[0] * to[0] + along[1] * to[1]) / squared
    share = min(max(share, 0.0), 1.0)
    return math.hypot(to[0] - share * along[0], to[1] - share * along[1])


class Support:
    """Support polygons of a robot with its feet at home, in the robot frame of a gait.

    Attributes:
        homes_m: place (x, y) of each foot.
        center_m: the centre of mass, from above; the mass of a leg counts halfway to its foot.
    """

    def __init__(self, robot: Robot, gait: Gait) -> None:
        legs = legs_of(robot)
        self.homes_m: list[Point] = [(x, y) for x, y in legs.under(gait).homes_m.tolist()]
        total = robot.torso_kg + math.fsum(legs.masses_kg)
        self.center_m = 0.0, 0.0
        for leg, kg, (x, y), azimuth in zip(
            robot.legs, legs.masses_kg, self.homes_m, gait.azimuths_deg, strict=True
        ):
            mount_x = -leg.radius_m * math.sin(math.radians(azimuth))
            mount_y = leg.radius_m * math.cos(math.radians(azimuth))
            share = kg / total / 2
            center_x, center_y = self.center_m
            self.center_m = center_x + share * (mount_x + x), center_y + share * (mount_y + y)

    @classmethod
    def of_points(cls, homes_m: Sequence[Point], center_m: Point) -> Self:
        """Return the support polygons of feet in some places under a centre of mass."""
        support = cls.__new__(cls)
        support.homes_m, support.center_m = list(homes_m), center_m
        return support

    def margin_m(self, swinging: Iterable[int] = ()) -> float:
        """Return the margin while some legs swing, counted from 1; of all feet by default [m]."""
        lifted = set(swinging)
        standing = [home for leg, home in enumerate(self.homes_m, start=1) if leg not in lifted]
        return margin_m(self.center_m, standing)

    def least_margin_m(self, groups: Iterable[Group]) -> float:
        """Return the least margin over the groups, each of which swings in turn [m]."""
        return min(map(self.margin_m, groups))

    def steadiest_groups(self) -> tuple[Group, ...]:
        """Return the fewest groups with which the robot stands, and of those the steadiest.

        Neighbours are in different groups where that is as steady. For many legs only two groups
        are tried, then each leg alone.
        """
        count = len(self.homes_m)
        for count_of_groups in (2, 3) if count <= _MAX_LEGS_OF_THREE_GROUPS else (2,):
            margins = [
                (self.least_margin_m(groups), groups)
                for groups in _divisions(count, count_of_groups)
            ]
            best, groups = max(
                margins, key=lambda candidate: (round(candidate[0], 6), _turns(candidate[1]))
            )
            if best >= STANDS_M:
                return groups
        return tuple((leg,) for leg in range(1, count + 1))


def _turns(groups: Sequence[Group]) -> int:
    """Return the number of adjacent pairs of legs around the body that are of different groups."""
    of_leg = [group for _, group in sorted((leg, legs) for legs in groups for leg in legs)]
    return sum(group is not other for group, other in pairwise([*of_leg, of_leg[0]]))


def _divisions(legs: int, groups: int) -> Iterable[tuple[Group, ...]]:
    """Iterate over the ways to divide legs into so many groups, each with one leg or more."""
    if groups == 2:
        other_legs = range(2, legs + 1)
        for size in range(legs - 1):
            for chosen in combinations(other_legs, size):
                yield (1, *chosen), tuple(leg for leg in other_legs if leg not in chosen)
        return
    for places in product(range(groups), repeat=legs - 1):
        numbered = (0, *places)
        firsts = [numbered.index(group) for group in range(groups) if group in numbered]
        if len(firsts) == groups and firsts == sorted(firsts):  # each division once
            yield tuple(
                tuple(leg for leg, group in enumerate(numbered, start=1) if group == number)
                for number in range(groups)
            )
