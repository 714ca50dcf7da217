"""What the paper says about its Figure 4, and about tuning."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from app.domain.types import FloatArray
from app.experiments.claims.cases import PAPERS_AGENT, Case
from app.experiments.claims.gaits import ODD_GAIT, gaits
from app.experiments.claims.judging import Claim, Finding
from app.experiments.formatting import gait_name, metres, percent, shares
from app.experiments.measures import WALKS
from app.experiments.statistics import Interval, Verdict, at_least, decided, paired_interval

FLAT = 0.25
"""The second thousand steps bring less than this part of the first, where a curve is flat."""
FIRST, MIDDLE, LAST = 250, 1000, 2000


class _Curve:
    """Q-learning's curve over all gaits at 250, 1,000 and 2,000 steps, as shares of greedy."""

    def __init__(self, case: Case) -> None:
        curves = [
            one
            for one in case.curves
            if one["agent"] == PAPERS_AGENT
            and one["greedy_m"]
            and {FIRST, MIDDLE, LAST} <= set(one["steps"])
        ]
        self._strata = [_shares(one) for one in curves]
        self._seed = case.seed
        self.fewest = min((one.shape[1] for one in self._strata), default=0)

    def over(self, number: Callable[[FloatArray], FloatArray]) -> Interval:
        """A number made of the curve's three heights, (3, …)."""
        return paired_interval(self._strata, number, self._seed)

    def at(self, steps: int) -> Interval:
        """The curve's height."""
        place = (FIRST, MIDDLE, LAST).index(steps)
        return self.over(lambda heights: heights[place])


def _shares(curve: Mapping[str, Any]) -> FloatArray:
    """Each seed at the three places, (3, n)."""
    at = [curve["points_m"][curve["steps"].index(steps)] for steps in (FIRST, MIDDLE, LAST)]
    return np.asarray(at, dtype=np.float64) / float(curve["greedy_m"])


def _judging(find: Callable[[_Curve], Finding]) -> Callable[[Case], Finding | None]:
    def find_in(case: Case) -> Finding | None:
        curve = _Curve(case)
        return find(curve) if curve.fewest else None

    return find_in


def _improves(curve: _Curve) -> Finding:
    middle = curve.at(MIDDLE)
    return Finding.of(
        decided(middle, WALKS, curve.fewest),
        f"{shares(curve.at(FIRST))} of greedy's distance after 250 steps, {shares(middle)} after "
        "1,000.",
    )


def _flattens(curve: _Curve) -> Finding:
    more = curve.over(lambda at: (at[2] - at[1]) - FLAT * at[1])
    middle, last = curve.at(MIDDLE), curve.at(LAST)
    adds = f"{percent(last.value / middle.value - 1)}" if middle.value > 0 else "all"
    return Finding.of(
        decided(-more, 0, curve.fewest),
        f"{shares(middle)} of greedy's distance after 1,000 steps, {shares(last)} after 2,000: the "
        f"second thousand steps add {adds} to what the first brought.",
    )


def _inclines(curve: _Curve) -> Finding:
    gain = curve.over(lambda at: at[2] - at[1])
    return Finding.of(
        decided(gain, 0, curve.fewest),
        f"From 1,000 to 2,000 steps the curve rises by {shares(gain)} of greedy's distance.",
    )


def _approaches(curve: _Curve) -> Finding:
    closer, last = curve.over(lambda at: at[2] - at[0]), curve.at(LAST)
    under = decided(-last, -1, curve.fewest)
    nearer = decided(closer, 0, curve.fewest)
    both: Verdict = (
        "no" if "no" in (under, nearer) else "yes" if under == nearer else "not established"
    )
    return Finding.of(
        both,
        f"From 250 to 2,000 steps the curve rises by {shares(closer)} of greedy's distance, to "
        f"{shares(last)} of it.",
    )


def _satisfies(case: Case) -> Finding | None:
    curve = case.curve(ODD_GAIT)
    if curve is None or curve["greedy_m"] is None:
        return None
    walkers = at_least(curve["points_m"][-1], WALKS * curve["greedy_m"])
    return Finding.of(
        walkers.against(0.5),
        f"After {curve['steps'][-1]:,} steps {shares(walkers)} of its seeds walk; the middle "
        f"covers {metres(curve['iqm_m'][-1])}, greedy {metres(curve['greedy_m'])}.",
    )


FIGURE4_CLAIMS: Sequence[Claim] = (
    Claim(
        "improves",
        "“improves substantially in the first few hundred trials, up to around 1000” (§5.1)",
        "It starts from nothing; after 1,000 steps the middle covers more than half of greedy's "
        "distance.",
        _judging(_improves),
    ),
    Claim(
        "flattens",
        "“the improvement flattens out quickly before 1000 steps of learning” (§5.1)",
        "The second thousand steps add less than a quarter of what the first brought.",
        _judging(_flattens),
    ),
    Claim(
        "inclines",
        "“the plateau in Figure 4 is really a small incline” (§6)",
        "From 1,000 to 2,000 steps the curve still rises.",
        _judging(_inclines),
    ),
    Claim(
        "approaches",
        "Greedy “is higher than all walking gaits, the Q-Learning curves slowly approach” (§5.1)",
        "After 2,000 steps the curve is under greedy, and nearer to it than after 250.",
        _judging(_approaches),
    ),
    *gaits(alike_after=2000, slow_after=500),
    Claim(
        "odd-gait-satisfies",
        f"{gait_name(ODD_GAIT)} “eventually Q-Learns its way to a satisfactory gait” (§5.1)",
        "After 2,000 steps more than half of the seeds cover half of greedy's distance.",
        _satisfies,
    ),
)
