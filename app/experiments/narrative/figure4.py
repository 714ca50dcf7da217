"""What Figure 4 shows."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from app.experiments.claims.cases import PAPERS_AGENT, Case
from app.experiments.formatting import agent_name, counted, gait_name, listed, metres, percent
from app.experiments.narrative.gaits import odd_gait

Curve = Mapping[str, Any]


def one_seed(places: Sequence[Case]) -> str | None:
    """The spread at the end of a curve, and how often a seed's own curve falls."""
    curves = [one for case in places for one in case.curves if one["steps"]]
    if not curves or len(curves[0]["points_m"][0]) < 2:
        return None
    one, at = curves[0], next(c.label for c in places if curves[0] in c.curves)
    last, falls = one["points_m"][-1], [_falls(curve) for curve in curves]
    blocks = sum(of for _, of in falls)
    return (
        f"The paper draws one curve a gait. Here every curve is {counted(len(last), 'seed')}: "
        "the line is the middle of them, the band its interval, the faint lines are the seeds. "
        f"{gait_name(one['gait'])} with {at}: after {one['steps'][-1]:,} steps the worst seed "
        f"covers {metres(min(last))}, the best {metres(max(last))}. A single seed's curve goes "
        f"down from one block to the next in {percent(sum(down for down, _ in falls) / blocks)} of "
        "cases; who draws one curve draws these dents as well."
    )


def _falls(curve: Curve) -> tuple[int, int]:
    """How often a seed comes less far than a block before, and of how many times."""
    pairs = [
        (before, after)
        for blocks in zip(curve["points_m"], curve["points_m"][1:], strict=False)
        for before, after in zip(*blocks, strict=True)
    ]
    return sum(after < before for before, after in pairs), max(1, len(pairs))


def readings(places: Sequence[Case]) -> str | None:
    """How the two readings differ, and which has the shape that the paper describes."""
    told = [_rise(case) for case in places]
    said = [one for one in told if one]
    if not said:
        return None
    return (
        "The paper does not say whether the robot reads back where its feet are, or remembers "
        f"where it sent them. {' '.join(said)} The paper prints no numbers for its Figure 4, but "
        "says that the curves rise fast at first and flatten before 1,000 steps. Which reading "
        "does so is among the claims above."
    )


def _rise(case: Case) -> str | None:
    """The middle of the gaits' curves at a few places, as shares of greedy."""
    curves = [
        one
        for one in case.curves
        if one["steps"] and one["greedy_m"] and one["agent"] == PAPERS_AGENT
    ]
    if not curves:
        return None
    steps = curves[0]["steps"]
    chosen = dict.fromkeys((steps[0], steps[(len(steps) - 1) // 2], steps[-1]))
    shown = [f"{percent(_mean_share(curves, steps.index(at)))} after {at:,}" for at in chosen]
    return (
        f"With {case.label} the curves stand, as a share of greedy and averaged over the gaits, "
        f"at {listed(shown)} steps."
    )


def _mean_share(curves: Sequence[Curve], block: int) -> float:
    return sum(float(one["iqm_m"][block] / one["greedy_m"]) for one in curves) / len(curves)


def rivals(places: Sequence[Case]) -> str | None:
    """Where several agents learn: how far each comes in the end."""
    said = []
    for case in places:
        pools = [one for one in case.pooled if one["relative"]]
        if len({one["agent"] for one in pools}) > 1:
            shown = [
                f"{agent_name(one['agent'])} {percent(one['relative']['iqm'])}" for one in pools
            ]
            said.append(f"With {case.label}: {listed(shown)}.")
    if not said:
        return None
    return f"At the end of the curves, as a share of greedy over all gaits. {' '.join(said)}"


FIGURE4_STORY: Sequence[tuple[str, Callable[[Sequence[Case]], str | None]]] = (
    ("One seed misleads", one_seed),
    ("Two readings of the same robot", readings),
    ("The agents", rivals),
    ("Why LeftRight-Vertical is the odd one", odd_gait),
)
