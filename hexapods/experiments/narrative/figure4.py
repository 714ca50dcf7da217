"""Paragraphs about Figure 4, the learning curves."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from hexapods.agents.appearance import title_of
from hexapods.domain.sums import ordered_sum
from hexapods.domain.text import counted, metres
from hexapods.experiments.claims.cases import PAPERS_AGENT, Case
from hexapods.experiments.claims.figure4 import one_go
from hexapods.experiments.formatting import listed, percent, shares
from hexapods.experiments.labels import gait_name
from hexapods.experiments.narrative.gaits import ODD_GAIT_HEADING, explain_odd_gait

Curve = Mapping[str, Any]


def describe_seed_spread(cases: Sequence[Case]) -> str | None:
    """Describe the seeds' spread at the end of a curve, and how often a single curve falls."""
    curves = [curve for case in cases for curve in case.curves if curve["steps"]]
    if not curves or len(curves[0]["points_m"][0]) < 2:
        return None
    curve, at = curves[0], next(c.label for c in cases if curves[0] in c.curves)
    last, falls = curve["points_m"][-1], [_falls(curve) for curve in curves]
    down, blocks = (sum(column) for column in zip(*falls, strict=True))  # whole numbers
    return (
        f"The paper draws one curve a gait. Here every curve is {counted(len(last), 'seed')}: "
        "the line is the middle of them, the band its interval, the faint lines are the seeds. "
        f"{gait_name(curve['gait'])} with {at}: after {curve['steps'][-1]:,} steps the worst seed "
        f"covers {metres(min(last))}, the best {metres(max(last))}. A single seed's curve goes "
        f"down from one block to the next in {percent(down / blocks)} of "
        "cases; who draws one curve draws these dents as well."
    )


def _falls(curve: Curve) -> tuple[int, int]:
    """Count the decreases of seeds' distances from one block to the next, and all such pairs."""
    pairs = [
        (before, after)
        for blocks in zip(curve["points_m"], curve["points_m"][1:], strict=False)
        for before, after in zip(*blocks, strict=True)
    ]
    return sum(after < before for before, after in pairs), max(1, len(pairs))


def compare_observations(cases: Sequence[Case]) -> str | None:
    """Compare the learning curves of the two observations with the shape the paper describes."""
    descriptions = [_describe_curve(case) for case in cases]
    sentences = [sentence for sentence in descriptions if sentence]
    if not sentences:
        return None
    return (
        "The paper does not say whether the robot measures where its feet are, or remembers "
        f"where it sent them. {' '.join(sentences)} The paper prints no numbers for its Figure 4, "
        "but says that the curves rise fast at first and flatten before 1,000 steps. Which reading "
        "does so is among the claims above."
    )


def _describe_curve(case: Case) -> str | None:
    """Describe the gaits' mean curve at its first, middle and last block, as shares of greedy."""
    curves = [
        curve
        for curve in case.curves
        if curve["steps"] and curve["greedy_m"] and curve["agent"] == PAPERS_AGENT
    ]
    if not curves:
        return None
    steps = curves[0]["steps"]
    chosen = dict.fromkeys((steps[0], steps[(len(steps) - 1) // 2], steps[-1]))
    shares = [f"{percent(_mean_share(curves, steps.index(at)))} after {at:,}" for at in chosen]
    return (
        f"With {case.label} the curves stand, as a share of greedy and averaged over the gaits, "
        f"at {listed(shares)} steps."
    )


def _mean_share(curves: Sequence[Curve], block: int) -> float:
    return ordered_sum(float(curve["iqm_m"][block] / curve["greedy_m"]) for curve in curves) / len(
        curves
    )


def compare_with_one_go(cases: Sequence[Case]) -> str | None:
    """Compare the blocks, in which ε restarts, with a practice of as many steps in one go."""
    compared = [(case, comparison) for case in cases if (comparison := one_go(case)) is not None]
    if not compared:
        return None
    verdicts = {
        "yes": "So the plateau is that of the restarted ε, not of the learner.",
        "no": "So there the restarted ε costs nothing.",
        "not established": "Whether one go is better there is not established.",
    }
    sentences = [
        f"With {case.label} the blocks come to {shares(comparison.in_blocks)} of greedy's distance "
        f"after 2,000 steps, a practice in one go to {shares(comparison.in_one_go)}: "
        f"a difference of {shares(comparison.gain)}. {verdicts[comparison.verdict]}"
        for case, comparison in compared
    ]
    return (
        "The paper saves the Q-values after every 250 steps and goes on from them. Each block is a "
        "training of its own, so ε begins again at 1 and falls to 0: eight times, so that the last "
        "block explores as much as the first. The dotted curve is the same Q-learning in one go, "
        f"in which ε falls once, from 1 to 0 over all 2,000 steps. {' '.join(sentences)}"
    )


def compare_agents(cases: Sequence[Case]) -> str | None:
    """Compare the final distances of the learning agents; None if there is only one."""
    sentences = []
    for case in cases:
        pools = [pool for pool in case.pooled if pool["relative"] and pool["blocks"] != 1]
        if len({pool["agent"] for pool in pools}) > 1:
            shares = [
                f"{title_of(pool['agent'])} {percent(pool['relative']['iqm'])}" for pool in pools
            ]
            sentences.append(f"With {case.label}: {listed(shares)}.")
    if not sentences:
        return None
    return f"At the end of the curves, as a share of greedy over all gaits. {' '.join(sentences)}"


FIGURE4_NARRATIVE: Sequence[tuple[str, Callable[[Sequence[Case]], str | None]]] = (
    ("One seed misleads", describe_seed_spread),
    ("The plateau and the restarted ε", compare_with_one_go),
    ("Two readings of the same robot", compare_observations),
    ("The agents", compare_agents),
    (ODD_GAIT_HEADING, explain_odd_gait),
)
