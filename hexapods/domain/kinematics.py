"""Legs of three joints, in closed form: coxa (yaw), femur and tibia (pitch); and reach of all legs.

The foot lies in the vertical plane that the coxa turns; in that plane femur and tibia are a
two-link arm with the knee above. Positive pitch lifts.
"""

import math
from collections.abc import Iterator, Sequence
from functools import lru_cache, singledispatch
from typing import Any, NamedTuple

import numpy as np

from hexapods.domain.chains import chain_legs
from hexapods.domain.errors import Unreachable
from hexapods.domain.feet import Reach
from hexapods.domain.gait import Gait
from hexapods.domain.grid import FootGrid
from hexapods.domain.legs import FootKinematics, Joint, Legs
from hexapods.domain.model_robot import ModelRobot
from hexapods.domain.robot import LegMount, Robot
from hexapods.domain.types import FloatArray

JOINT_LIMITS_RAD = {"coxa": (-1.2, 1.2), "femur": (-1.4, 1.9), "tibia": (-2.8, 0.0)}
"""Joint limits (low, high), used by the model's joint ranges and by `check_reach`."""


class _CoxaFemurTibia(Legs):
    def __init__(self, robot: Robot) -> None:
        links = map(robot.of_legs, ("coxa_kg", "femur_kg", "tibia_kg", "foot_kg"))
        super().__init__(
            [
                Joint(leg, name, limits)
                for leg in range(1, len(robot.legs) + 1)
                for name, limits in JOINT_LIMITS_RAD.items()
            ],
            [coxa + femur + tibia + foot for coxa, femur, tibia, foot in zip(*links, strict=True)],
        )
        self._robot, self._links = robot, _link_lengths_of(robot)

    def feet_in_body(self, angles: FloatArray) -> FloatArray:
        legs = self._robot.legs
        coxa, femur, tibia = np.moveaxis(angles.reshape(len(angles), -1, 3), -1, 0)
        along, across, height = _foot(
            _LinkLengths(*np.array(self._links).T), coxa, femur, tibia, np
        )
        radius, z = (np.array([getattr(leg, name) for leg in legs]) for name in ("radius_m", "z_m"))
        azimuth, yaw = _directions(legs)
        along = along + radius
        cos, sin = np.cos(yaw), np.sin(yaw)
        # The mount is off the line of a leg that does not point away from the torso's centre.
        off_x, off_y = radius * (np.cos(azimuth) - cos), radius * (np.sin(azimuth) - sin)
        return np.stack(
            [along * cos - across * sin + off_x, along * sin + across * cos + off_y, height + z],
            axis=-1,
        )

    def links_in_body(self, angles: Sequence[float]) -> list[FloatArray]:
        azimuths, yaws = (each.tolist() for each in _directions(self._robot.legs))
        links = []
        for number, leg in enumerate(self._robot.legs):
            coxa, femur, tibia = angles[3 * number : 3 * number + 3]
            lengths, yaw = self._links[number], yaws[number] + coxa
            knee = (
                lengths.coxa + lengths.femur * math.cos(femur),
                lengths.femur * math.sin(femur),
            )
            foot = (
                knee[0] + lengths.tibia * math.cos(femur + tibia),
                knee[1] + lengths.tibia * math.sin(femur + tibia),
            )
            mount = np.array(
                [
                    leg.radius_m * math.cos(azimuths[number]),
                    leg.radius_m * math.sin(azimuths[number]),
                    leg.z_m,
                ]
            )
            along = np.array([math.cos(yaw), math.sin(yaw), 0])
            profile = np.array([(0.0, 0.0), (lengths.coxa, 0.0), knee, foot])
            links.append(mount + profile[:, :1] * along + profile[:, 1:] * np.array([0, 0, 1]))
        return links

    def under(self, gait: Gait) -> FootKinematics:
        return _CoxaFemurTibiaKinematics(self, self._robot, gait)


class _CoxaFemurTibiaKinematics(FootKinematics):
    def __init__(self, legs: Legs, robot: Robot, gait: Gait) -> None:
        self.legs, self._robot = legs, robot
        azimuth = np.deg2rad(gait.azimuths_deg)
        yaw = azimuth + np.subtract(*_directions(robot.legs)[::-1])
        sin, cos = np.sin(yaw), np.cos(yaw)
        radius, home = np.array([leg.radius_m for leg in robot.legs]), np.array(robot.feet_out_m)
        points_away = robot.span_m if robot.span_m == robot.home_radius_m else radius + home
        self.homes_m = (
            points_away * np.stack([-sin, cos])
            + radius * np.stack([sin - np.sin(azimuth), np.cos(azimuth) - cos])
        ).T
        heights = robot.body_height_m + np.array([leg.z_m for leg in robot.legs])
        self._links = _link_lengths_of(robot)
        coxa, femur, tibia = np.array(self._links).T
        self.frames = np.array(
            [
                (home, 0 * home),
                (-sin, -cos),
                (cos, -sin),
                (coxa, heights),
                (femur, tibia),
                (femur * femur + tibia * tibia, 2 * femur * tibia),
            ]
        )
        """For each leg, (6, 2, legs): an affine map from the robot frame to the leg's frame, which
        is home's position from the coxa joint [m], the coefficients of x, the coefficients of y,
        each along the leg and across; then lengths of the coxa and height of its joint, lengths of
        femur and tibia, the sum of their squares and twice their product."""
        self._numbers = [frame[:3].ravel().tolist() for frame in np.moveaxis(self.frames, -1, 0)]
        self._heights_m = heights.tolist()

    def mirrored(self, signs: FloatArray) -> FloatArray:
        frames = self.frames.copy()
        frames[1] *= signs
        return frames

    def solve(self, places: FloatArray, heights: FloatArray, frames: FloatArray) -> FloatArray:
        # Coordinates are separate contiguous arrays: NumPy's loops over strided arrays are slower,
        # and may differ in the last bit.
        home, of_x, of_y, (coxa, height), (femur, tibia), (squared, twice) = frames
        feet = home + (of_x * places[0] + of_y * places[1])  # (2, ...): along the leg, across
        squares = feet * feet
        r = np.sqrt(squares[0] + squares[1]) - coxa
        fall = heights - height
        bend = (r * r + fall * fall - squared) / twice
        drop = np.sqrt(1 - bend * bend)
        angles = np.empty((*r.shape, 3))
        angles[..., 0] = np.arctan2(feet[1], feet[0])
        angles[..., 1] = np.arctan2(fall, r) + np.arctan2(tibia * drop, femur + tibia * bend)
        angles[..., 2] = -np.arctan2(drop, bend)
        return angles

    def foot_offsets(self, angles: Sequence[float]) -> list[tuple[float, float, float]]:
        offsets = []
        for leg, (home, _, x_along, x_across, y_along, y_across) in enumerate(self._numbers):
            coxa, femur, tibia = angles[3 * leg : 3 * leg + 3]
            reach, across, height = _foot(self._links[leg], coxa, femur, tibia, math)
            along = reach - home
            offsets.append(
                (
                    x_along * along + x_across * across,
                    y_along * along + y_across * across,
                    height + self._heights_m[leg],
                )
            )
        return offsets


class _LinkLengths(NamedTuple):
    """Lengths of the links of a leg [m], or of all legs, (legs,)."""

    coxa: Any
    femur: Any
    tibia: Any


def _link_lengths_of(robot: Robot) -> list[_LinkLengths]:
    links = map(robot.of_legs, ("coxa_m", "femur_m", "tibia_m"))
    return [_LinkLengths(*lengths_m) for lengths_m in zip(*links, strict=True)]


def _directions(legs: Sequence[LegMount]) -> tuple[FloatArray, FloatArray]:
    """Return the azimuths of the mounts, and the directions of the legs [rad], (legs,)."""
    azimuths, yaws = (
        [getattr(leg, name) for leg in legs] for name in ("azimuth_deg", "direction_deg")
    )
    return np.deg2rad(azimuths), np.deg2rad(yaws)


def _foot(
    leg: _LinkLengths, coxa: Any, femur: Any, tibia: Any, functions: Any
) -> tuple[Any, Any, Any]:
    """Return a foot's place from its coxa joint: along the leg, across, and upward [m].

    Angles [rad] are floats with `math` for `functions`, or arrays with `numpy`.
    """
    knee = femur + tibia
    cos, sin = functions.cos, functions.sin
    r = leg.coxa + leg.femur * cos(femur) + leg.tibia * cos(knee)
    height = leg.femur * sin(femur) + leg.tibia * sin(knee)
    return r * cos(coxa), r * sin(coxa), height


_coxa_femur_tibia = lru_cache(maxsize=64)(_CoxaFemurTibia)


@singledispatch
def legs_of(robot: Robot) -> Legs:
    """Return the legs of a robot. A kind of robot with other legs registers its own function."""
    return _coxa_femur_tibia(robot)


@legs_of.register
def _(robot: ModelRobot) -> Legs:
    return chain_legs(robot)


_REACH_SAMPLES = 8
"""Positions from home to the farthest that can occur in each direction, where reach is limited."""


@lru_cache(maxsize=64)
def check_reach(robot: Robot, gait: Gait, grid: FootGrid) -> Reach | None:
    """Check that each leg reaches its grid; return the range of offsets to which feet may drift.

    A foot's actual forward offset drifts as the body re-centres. It stays strictly within
    (1 − w) / w · h of home, h half the grid's side, w its group's share of all feet: the offsets of
    the feet sum to zero, and each group was last commanded to within h. Only long series of odd
    steps lead there, so a robot may walk whose legs reach less. Cached, since every run of an
    experiment checks it again.

    Returns:
        None if every offset that can occur is within reach and joint limits; otherwise the range
        of those that are.

    Raises:
        Unreachable: if a foot does not reach a cell from home, naming the leg and the cell.
    """
    reaches_all = True
    for passage in _passages(robot, gait, grid):
        problem = next(_reach_problems(legs_of(robot), passage.angles), None)
        if problem and passage.why is None:
            reaches_all = False
        elif problem:
            leg, reason = problem
            raise Unreachable(passage.sentence(leg, reason), [leg])
    return None if reaches_all else _forward_reach(robot, gait, grid)


def out_of_reach(robot: Robot, gait: Gait, grid: FootGrid) -> dict[int, str]:
    """Return a sentence for each leg that does not reach its grid, by the leg's number."""
    problems: dict[int, str] = {}
    for passage in _passages(robot, gait, grid):
        if passage.why is not None:
            for leg, reason in _reach_problems(legs_of(robot), passage.angles):
                problems.setdefault(leg, passage.sentence(leg, reason))
    return problems


class _Passage(NamedTuple):
    """The feet of all legs on their way to a cell.

    Attributes:
        grid, cell: the cell, by its number.
        why: place on the way, for the error message; None for a drift that only long series of
            odd steps lead to.
        angles: angles of all joints [rad], NaN where a foot is out of reach.
    """

    grid: FootGrid
    cell: int
    why: str | None
    angles: FloatArray

    def sentence(self, leg: int, reason: str) -> str:
        return (
            f"leg {leg} cannot reach cell {self.cell} ({self.grid.name(self.cell)}){self.why}: "
            f"{reason}; choose a smaller grid_side_m than {self.grid.side_m:g}, a "
            "lower step_height_m, or other link lengths, home radius or body height"
        )


def _passages(robot: Robot, gait: Gait, grid: FootGrid) -> Iterator[_Passage]:
    """Iterate over the places that each foot has to reach, cell by cell."""
    legs = legs_of(robot)
    kinematics, count = legs.under(gait), len(legs)
    sizes = np.array(gait.sizes)[list(gait.group_of_leg)]
    drift = (count - sizes) / sizes
    for cell, (x, y) in enumerate(grid.cells):
        passages = (
            ("", np.full(count, y)),
            (None, drift * y),
            (" on the way there", np.zeros(count)),
        )
        for why, forward in passages:
            for height in (0.0, robot.step_height_m):
                # Both (x, y) and (−x, y) are cells, so mirrored legs have the same places.
                offsets = np.column_stack((np.full(count, x), forward, np.full(count, height)))
                yield _Passage(grid, cell, why, kinematics.joint_angles(offsets))


def _forward_reach(robot: Robot, gait: Gait, grid: FootGrid) -> Reach:
    """Return the forward and backward reach of each group's feet, at every sideways offset [m].

    Raises:
        Unreachable: if the reach is less than the grid, or a foot does not reach a place between.
    """
    legs, half = legs_of(robot), grid.half_side_m
    kinematics = legs.under(gait)
    widths = np.linspace(-half, half, 2 * _REACH_SAMPLES + 1)
    heights = np.linspace(0, robot.step_height_m, 4)
    back: list[float] = []
    ahead: list[float] = []
    for group in gait.groups:
        # From the grid's edge to the farthest that can occur, away from home and towards it.
        farthest = half * max(1.0, (len(legs) - len(group)) / len(group))
        outward = np.concatenate(
            (
                np.linspace(0, half, _REACH_SAMPLES, endpoint=False),
                np.linspace(half, farthest, 4 * _REACH_SAMPLES),
            )
        )
        of_group = np.isin(legs.leg_of_joint, np.array(group) - 1)
        low, high = legs.limits_rad[:, of_group]
        for sign, distances in ((-1, back), (1, ahead)):
            x, y, z = np.meshgrid(widths, sign * outward, heights, indexing="ij")
            offsets = np.stack((x, y, z), -1)[..., None, :].repeat(len(legs), -2)
            angles = kinematics.joint_angles(offsets)[..., of_group]
            is_possible = ((low <= angles) & (angles <= high)).all(axis=(0, 2, 3))
            reached = outward[: int(is_possible.argmin())] if not is_possible.all() else outward
            if len(reached) <= _REACH_SAMPLES:
                names = " and ".join(map(str, group))
                raise Unreachable(
                    f"leg {names} cannot reach everywhere between the cells of its grid: choose a "
                    f"smaller grid_side_m than {grid.side_m:g}, a lower step_height_m, or other "
                    "link lengths, home radius or body height",
                    group,
                )
            distances.append(sign * float(reached[-1]))
    return Reach(tuple(back), tuple(ahead))


def _reach_problems(legs: Legs, angles: FloatArray) -> Iterator[tuple[int, str]]:
    """Yield the legs that cannot have these joint angles, (joints,), with the reason."""
    low, high = legs.limits_rad
    is_possible = (low <= angles) & (angles <= high)
    if is_possible.all():
        return
    reported_leg = 0
    for index in np.flatnonzero(~is_possible).tolist():
        joint = legs.joints[index]
        if joint.leg == reported_leg:
            continue
        reported_leg = joint.leg
        if np.isnan(angles[legs.leg_of_joint == joint.leg - 1]).any():
            yield joint.leg, "it is out of the reach of its links"
        else:
            turned = np.rad2deg(angles[index])
            yield joint.leg, f"its {joint.name} would turn to {turned:.0f}°, beyond its limit"
