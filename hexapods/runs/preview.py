"""Preview of a walking problem before anything runs: support, reach, states, the law."""

import math
from bisect import bisect_left
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from hexapods.agents.q_table import MAX_VALUES, table_size
from hexapods.domain.body import Robot
from hexapods.domain.errors import Unreachable
from hexapods.domain.gait import AnyGait, Gait, GaitSpec, gait_spec
from hexapods.domain.grid import MAX_SIDE_M, FootGrid
from hexapods.domain.kinematics import check_reach, legs_of, out_of_reach
from hexapods.domain.legs import Legs
from hexapods.domain.records import Record
from hexapods.domain.robot import legs_written_out, written_out
from hexapods.domain.sums import ordered_sum
from hexapods.domain.support import STANDS_M, Support
from hexapods.runs.config import RACE_STEPS, WalkingProblem
from hexapods.runs.recommendation import recommend

_SIDE_STEP_M = 0.005
"""Grids are tried in steps of this size."""


@dataclass(frozen=True)
class LegPreview(Record):
    """A leg, with its foot in the robot frame.

    Attributes:
        leg: number of the leg.
        group: number of its group, from 0.
        side: 1 on the right, -1 on the left, 0 on the axis or mirrored otherwise.
        home_m: place of its foot at home: right, forward.
        mass_kg: mass of the leg, with the foot.
        out_of_reach: sentence on a cell of its grid that it cannot reach; null if it reaches all.
        follows_grid: whether its foot can go to any place near home; one of two joints cannot.
        built: all numbers of the leg, as in a request: its place by `x_m` and `y_m`.
        links_m: places of its joints and foot while the robot stands, from the torso outward:
            right, forward, up from the torso's centre; null if it cannot stand.
    """

    leg: int
    group: int
    side: int
    home_m: tuple[float, float]
    mass_kg: float
    out_of_reach: str | None
    follows_grid: bool
    built: dict[str, float]
    links_m: list[tuple[float, float, float]] | None


@dataclass(frozen=True)
class GroupPreview(Record):
    """A group of legs.

    Attributes:
        legs: numbers of the legs.
        margin_m: support margin while the group swings: distance of the centre of mass from the
            edge of the polygon of the other feet; below 0 the robot tips.
        back_m, ahead_m: reach of its feet from home; null where they reach all that can occur.
    """

    legs: list[int]
    margin_m: float
    back_m: float | None
    ahead_m: float | None


@dataclass(frozen=True)
class BetterGroups(Record):
    """Groups with which a robot that tips would stand.

    Attributes:
        gait: the gait with these groups.
        margin_m: least support margin of the gait.
        states: number of states with the gait.
    """

    gait: AnyGait
    margin_m: float
    states: int


@dataclass(frozen=True)
class Preview(Record):
    """Preview of a walking problem.

    Attributes:
        gait: the gait with its groups leg by leg.
        forward_deg: forward direction of the gait, anticlockwise from body x.
        cells_m: cells of the foot grid by their places from home: right, forward.
        built: all numbers of the robot that legs share; a torso that is no box has null for one.
        legs: leg by leg.
        groups: group by group.
        margin_m: least support margin over the groups.
        tips: whether that is below 0: it then tips onto the feet that swing, and drags.
        stands: whether it stands on all of its feet.
        mass_kg: mass of the whole robot.
        states, actions, values: size of a table: states, legal actions in each, and their product.
        table_fits: whether a learner with a table can start.
        law_m_per_step: advance of the steady walk by the law without slip.
        law_m: advance of 50 steps, a race, by that law.
        out_of_reach: sentence on a cell that a leg cannot reach; null if all legs reach all.
        largest_side_m: largest grid side with which it may walk; null if it reaches none.
        safe_side_m: largest grid side with which every action is always possible; likewise.
        beside_grid: sentence on the legs that cannot follow the grid; null if all can.
        better: groups to take instead; null if it does not tip, or tips with any.
        recommended_agent: learner to begin with, by the support margin.
        recommended_because: reason of the recommendation, in a sentence.
    """

    gait: AnyGait
    forward_deg: float
    cells_m: list[tuple[float, float]]
    built: dict[str, float | None]
    legs: list[LegPreview]
    groups: list[GroupPreview]
    margin_m: float
    tips: bool
    stands: bool
    mass_kg: float
    states: int
    actions: int
    values: int
    table_fits: bool
    law_m_per_step: float
    law_m: float
    out_of_reach: str | None
    largest_side_m: float | None
    safe_side_m: float | None
    beside_grid: str | None
    better: BetterGroups | None
    recommended_agent: str
    recommended_because: str


def preview(walk: WalkingProblem) -> Preview:
    """Return the preview of a walking problem, computed without simulation."""
    robot, gait, grid = walk.robot, walk.resolved_gait, walk.grid
    legs, support = legs_of(robot), Support(robot, gait)
    least, cells = support.least_margin_m(gait.groups), len(grid)
    reach, unreached = None, dict[int, str]()
    try:
        reach = check_reach(robot, gait, grid)
    except Unreachable as error:
        unreached = dict.fromkeys(error.legs, str(error)) | out_of_reach(robot, gait, grid)
    groups = [
        GroupPreview(
            list(group),
            support.margin_m(group),
            None if reach is None else reach.back_m[number],
            None if reach is None else reach.ahead_m[number],
        )
        for number, group in enumerate(gait.groups)
    ]
    largest, safe = _largest_sides_m(robot, gait, grid.divisions)
    states, actions = cells ** len(gait.groups), len(gait.groups) * (cells - 1)
    advance_m = law_m_per_step(gait, grid)
    spec = gait_spec(walk.gait)
    recommended = recommend(robot, gait, cells)
    return Preview(
        gait=GaitSpec(spec.right_leg, spec.left_leg, groups=gait.groups),
        forward_deg=gait.forward_deg,
        cells_m=list(grid.places_m),
        built=written_out(robot),
        legs=[
            LegPreview(leg, group, side, home, kg, unreached.get(leg), follows, built, links)
            for leg, (group, side, home, kg, follows, built, links) in enumerate(
                zip(
                    gait.group_of_leg,
                    gait.mirror,
                    support.homes_m,
                    legs.masses_kg,
                    legs.follows_grid,
                    legs_written_out(robot),
                    _standing_links_m(robot, gait),
                    strict=True,
                ),
                start=1,
            )
        ],
        groups=groups,
        margin_m=least,
        tips=least < STANDS_M,
        stands=support.margin_m() >= STANDS_M,
        mass_kg=robot.torso_kg + ordered_sum(legs.masses_kg),
        states=states,
        actions=actions,
        values=states * actions,
        table_fits=table_size(len(gait.groups), cells) <= MAX_VALUES,
        law_m_per_step=advance_m,
        law_m=RACE_STEPS * advance_m,
        out_of_reach=next(iter(unreached.values()), None),
        largest_side_m=largest,
        safe_side_m=safe,
        beside_grid=_beside_grid(legs),
        better=_better(walk, support) if least < STANDS_M else None,
        recommended_agent=recommended.agent,
        recommended_because=recommended.reason,
    )


def _beside_grid(legs: Legs) -> str | None:
    """Return a sentence on the legs that cannot follow a grid, if there are some."""
    if all(legs.follows_grid):
        return None
    numbers = [leg for leg, follows in enumerate(legs.follows_grid, start=1) if not follows]
    named = f"legs {', '.join(map(str, numbers))}" if numbers[1:] else f"leg {numbers[0]}"
    return (
        f"the joints of {named} move the foot in a surface only: it goes to the nearest place of "
        "the right height that it reaches, beside the cell"
    )


def _standing_links_m(robot: Robot, gait: Gait) -> list[list[tuple[float, float, float]] | None]:
    """Return the places of the joints and the foot of each leg with the feet at home."""
    legs = legs_of(robot)
    angles = legs.under(gait).joint_angles(np.zeros((len(legs), 3)))
    turn = math.radians(90 - gait.forward_deg)
    cos, sin = math.cos(turn), math.sin(turn)
    return [
        [(x * cos - y * sin, x * sin + y * cos, z) for x, y, z in places.tolist()]
        if np.isfinite(places).all()
        else None
        for places in legs.links_in_body(angles.tolist())
    ]


def law_m_per_step(gait: Gait, grid: FootGrid) -> float:
    """Return the advance of a steady walk without slip: 2 h / (G (1 + Σ w²)) [m].

    The G groups, w their shares of the feet, take turns to the front edge, h ahead of home.
    """
    legs = sum(gait.sizes)  # whole numbers
    squares = ordered_sum((size / legs) ** 2 for size in gait.sizes)
    return 2 * grid.half_side_m / (len(gait.sizes) * (1 + squares))


@lru_cache(maxsize=64)
def _largest_sides_m(robot: Robot, gait: Gait, divisions: int) -> tuple[float | None, float | None]:
    """Return the largest side of a grid that feet reach, and of one that they never leave [m]."""

    def is_unreached(side: int) -> bool:
        try:
            check_reach(robot, gait, FootGrid(side * _SIDE_STEP_M, divisions))
        except Unreachable:
            return True
        return False

    def is_left(side: int) -> bool:
        return check_reach(robot, gait, FootGrid(side * _SIDE_STEP_M, divisions)) is not None

    sides = range(1, round(MAX_SIDE_M / _SIDE_STEP_M) + 1)
    reached = bisect_left(sides, 1, key=is_unreached)
    safe = bisect_left(sides[:reached], 1, key=is_left)
    largest, within_limits = (round(n * _SIDE_STEP_M, 3) if n else None for n in (reached, safe))
    return largest, within_limits


def _better(walk: WalkingProblem, support: Support) -> BetterGroups | None:
    """Return other groups with the same forward direction, with which the robot stands."""
    spec = gait_spec(walk.gait)
    groups = support.steadiest_groups()
    margin = support.least_margin_m(groups)
    if margin < STANDS_M:
        return None
    gait = GaitSpec(spec.right_leg, spec.left_leg, groups=groups)
    return BetterGroups(gait, margin, len(walk.grid) ** len(groups))
