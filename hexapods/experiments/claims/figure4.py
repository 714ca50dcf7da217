"""The paper's claims about its Figure 4, the learning curves."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from hexapods.domain.text import metres
from hexapods.domain.types import FloatArray
from hexapods.experiments.claims.cases import PAPERS_AGENT, Case
from hexapods.experiments.claims.gaits import ODD_GAIT, gait_claims
from hexapods.experiments.claims.judging import CaseFinding, Claim
from hexapods.experiments.formatting import percent, shares
from hexapods.experiments.labels import gait_name_with_papers
from hexapods.experiments.measures import WALKER_SHARE
from hexapods.experiments.statistics import (
    Interval,
    Points,
    Verdict,
    bootstrap_exceeds,
    interval,
    iqm_interval,
    paired_interval,
    pooled_iqm,
    share_at_least,
)

FLAT_RATIO = 0.25
"""A curve counts as flat if steps 1,001 to 2,000 add less than this share of the first 1,000."""
FIRST, MIDDLE, LAST = 250, 1000, 2000


class _Curve:
    """Q-learning's learning curve over all gaits at 250, 1,000 and 2,000 steps.

    Heights are shares of greedy's distance; the gaits are the strata.
    """

    def __init__(self, case: Case) -> None:
        curves = [
            curve
            for curve in case.curves
            if curve["agent"] == PAPERS_AGENT
            and curve["greedy_m"]
            and {FIRST, MIDDLE, LAST} <= set(curve["steps"])
        ]
        self._strata = [_shares(curve) for curve in curves]
        self._seed = case.seed
        self.fewest = min((stratum.shape[1] for stratum in self._strata), default=0)

    def statistic(self, number: Callable[[FloatArray], FloatArray]) -> Interval:
        """Return the interval of a function of the curve's three heights, (3, …)."""
        return paired_interval(self._strata, number, self._seed)

    def at(self, steps: int) -> Interval:
        """Return the curve's height at one of the three steps."""
        place = (FIRST, MIDDLE, LAST).index(steps)
        return self.statistic(lambda heights: heights[place])


def _shares(curve: Mapping[str, Any]) -> FloatArray:
    """Return each seed's share of greedy's distance at the three steps, (3, n)."""
    at = [curve["points_m"][curve["steps"].index(steps)] for steps in (FIRST, MIDDLE, LAST)]
    return np.asarray(at, dtype=np.float64) / float(curve["greedy_m"])


class OneGo(NamedTuple):
    """Q-learning's distance after all its steps in one go, beside that in blocks.

    Attributes:
        in_blocks, in_one_go: shares of greedy's distance over all gaits.
        gain: by how much the one in one go is larger.
        verdict: whether it is.
    """

    in_blocks: Interval
    in_one_go: Interval
    gain: Interval
    verdict: Verdict


def one_go(case: Case) -> OneGo | None:
    """Compare a practice in which ε falls once with as many steps in blocks; None without both."""
    blocks, whole = (_last_shares(curves) for curves in (case.curves, case.in_one_go))
    if not blocks or not whole:
        return None

    def gain(*strata: FloatArray, axis: int = -1) -> FloatArray:
        in_blocks = pooled_iqm(*strata[: len(blocks)], axis=axis)
        return np.asarray(pooled_iqm(*strata[len(blocks) :], axis=axis) - in_blocks)

    gained = interval((*blocks, *whole), gain, case.seed)
    fewest = min(map(len, (*blocks, *whole)))
    return OneGo(
        iqm_interval(blocks, case.seed),
        iqm_interval(whole, case.seed),
        gained,
        bootstrap_exceeds(gained, 0, fewest),
    )


def _last_shares(curves: Sequence[Mapping[str, Any]]) -> tuple[Points, ...]:
    """Return each seed's share of greedy's distance at the end of Q-learning's curves, by gait."""
    return tuple(
        tuple(distance_m / float(curve["greedy_m"]) for distance_m in curve["points_m"][-1])
        for curve in curves
        if curve["agent"] == PAPERS_AGENT and curve["greedy_m"] and curve["steps"][-1:] == [LAST]
    )


def _beside_one_go(case: Case) -> str:
    """Return a sentence about the practice in one go; empty where there is none yet."""
    compared = one_go(case)
    if compared is None:
        return ""
    return (
        f" That is in blocks, in each of which ε begins again at 1; in one go 2,000 steps come to "
        f"{shares(compared.in_one_go)} of greedy's distance."
    )


def _judge_curve(
    find: Callable[[_Curve], CaseFinding], more: Callable[[Case], str] = lambda _: ""
) -> Callable[[Case], CaseFinding | None]:
    """Return the function that judges a claim by the curve in blocks.

    Args:
        find: judges it.
        more: a further sentence of its evidence, with a space before it.
    """

    def find_in(case: Case) -> CaseFinding | None:
        curve = _Curve(case)
        if not curve.fewest:
            return None
        finding = find(curve)
        return finding._replace(evidence=finding.evidence + more(case))

    return find_in


def _improves(curve: _Curve) -> CaseFinding:
    middle = curve.at(MIDDLE)
    return CaseFinding.of(
        bootstrap_exceeds(middle, WALKER_SHARE, curve.fewest),
        f"{shares(curve.at(FIRST))} of greedy's distance after 250 steps, {shares(middle)} after "
        "1,000.",
    )


def _flattens(curve: _Curve) -> CaseFinding:
    more = curve.statistic(lambda at: (at[2] - at[1]) - FLAT_RATIO * at[1])
    middle, last = curve.at(MIDDLE), curve.at(LAST)
    adds = f"{percent(last.value / middle.value - 1)}" if middle.value > 0 else "all"
    return CaseFinding.of(
        bootstrap_exceeds(-more, 0, curve.fewest),
        f"{shares(middle)} of greedy's distance after 1,000 steps, {shares(last)} after 2,000: the "
        f"second thousand steps add {adds} to what the first brought.",
    )


def _inclines(curve: _Curve) -> CaseFinding:
    gain = curve.statistic(lambda at: at[2] - at[1])
    return CaseFinding.of(
        bootstrap_exceeds(gain, 0, curve.fewest),
        f"From 1,000 to 2,000 steps the curve rises by {shares(gain)} of greedy's distance.",
    )


def _approaches(curve: _Curve) -> CaseFinding:
    closer, last = curve.statistic(lambda at: at[2] - at[0]), curve.at(LAST)
    under = bootstrap_exceeds(-last, -1, curve.fewest)
    nearer = bootstrap_exceeds(closer, 0, curve.fewest)
    verdict: Verdict = (
        "no" if "no" in (under, nearer) else "yes" if under == nearer else "not established"
    )
    return CaseFinding.of(
        verdict,
        f"From 250 to 2,000 steps the curve rises by {shares(closer)} of greedy's distance, to "
        f"{shares(last)} of it.",
    )


def _satisfies(case: Case) -> CaseFinding | None:
    curve = case.curve(ODD_GAIT)
    if curve is None or curve["greedy_m"] is None:
        return None
    walkers = share_at_least(curve["points_m"][-1], WALKER_SHARE * curve["greedy_m"])
    return CaseFinding.of(
        walkers.exceeds(0.5),
        f"After {curve['steps'][-1]:,} steps {shares(walkers)} of its seeds walk; the middle "
        f"covers {metres(curve['iqm_m'][-1])}, greedy {metres(curve['greedy_m'])}.",
    )


FIGURE4_CLAIMS: Sequence[Claim] = (
    Claim(
        "improves",
        "“improves substantially in the first few hundred trials, up to around 1000” (§5.1)",
        "It starts from nothing; after 1,000 steps the middle covers more than half of greedy's "
        "distance.",
        _judge_curve(_improves),
    ),
    Claim(
        "flattens",
        "“the improvement flattens out quickly before 1000 steps of learning” (§5.1)",
        "The second thousand steps add less than a quarter of what the first brought.",
        _judge_curve(_flattens, _beside_one_go),
    ),
    Claim(
        "inclines",
        "“the plateau in Figure 4 is really a small incline” (§6)",
        "From 1,000 to 2,000 steps the curve still rises.",
        _judge_curve(_inclines, _beside_one_go),
    ),
    Claim(
        "approaches",
        "Greedy “is higher than all walking gaits, the Q-Learning curves slowly approach” (§5.1)",
        "After 2,000 steps the curve is under greedy, and nearer to it than after 250.",
        _judge_curve(_approaches),
    ),
    *gait_claims(alike_after=2000, slow_after=500),
    Claim(
        "odd-gait-satisfies",
        f"{gait_name_with_papers(ODD_GAIT)} “eventually Q-Learns its way to a satisfactory gait” "
        "(§5.1)",
        "After 2,000 steps more than half of the seeds cover half of greedy's distance.",
        _satisfies,
    ),
)
