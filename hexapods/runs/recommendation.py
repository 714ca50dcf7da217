"""Recommend a learner for a robot in a gait by its support margin, before it walks."""

from typing import NamedTuple

from hexapods.agents.multilevel_model import MAX_PAIRS
from hexapods.agents.q_table import table_size
from hexapods.domain.body import Robot
from hexapods.domain.gait import Gait
from hexapods.domain.support import STANDS_M, Support

FOR_STANDING, FOR_TIPPING = "linear-model", "multilevel-model"


class Recommendation(NamedTuple):
    """A learner, and why.

    Attributes:
        agent: its registered name.
        reason: in a sentence.
    """

    agent: str
    reason: str


def recommend(robot: Robot, gait: Gait, cells: int) -> Recommendation:
    """Return the learner to begin with, by the support margin.

    Where a robot stands, a step's reward is nearly a sum over where its feet stand after landing,
    as `linear-model` assumes. Where it tips, the reward depends on which group moved as well, as
    `multilevel-model` learns, unless it has too many state-action pairs to plan for
    (docs/creatures.md has the figures).

    Args:
        robot: the robot.
        gait: its gait.
        cells: number of cells of the foot grid.
    """
    margin_m = Support(robot, gait).least_margin_m(gait.groups)
    if margin_m >= STANDS_M:
        return Recommendation(
            FOR_STANDING,
            f"It stands while each group swings (support margin {_millimetres(margin_m)}), so what "
            "a step earns is nearly a sum over where its feet stand, which this learner assumes.",
        )
    tips = f"It tips while a group swings (support margin {_millimetres(margin_m)})"
    pairs = table_size(len(gait.groups), cells)
    if pairs > MAX_PAIRS:
        return Recommendation(
            FOR_STANDING,
            f"{tips}, but has {pairs:,} state-action pairs, too many for a learner that tells by "
            "which group its feet came there: this one takes any number.",
        )
    return Recommendation(
        FOR_TIPPING,
        f"{tips}, so what a step earns depends also on which group moved, which this learner "
        "tells apart.",
    )


def _millimetres(metres: float) -> str:
    return f"{round(1000 * metres) or 0}\N{NO-BREAK SPACE}mm".replace("-", "−")
