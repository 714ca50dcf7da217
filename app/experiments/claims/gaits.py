"""What the paper says about its gaits: alike, but for one."""

from functools import partial

import numpy as np

from app.domain.types import FloatArray
from app.experiments.claims.cases import Case
from app.experiments.claims.judging import Claim, Finding
from app.experiments.formatting import metres, percent, shares, span
from app.experiments.published import GAITS
from app.experiments.statistics import Interval, Points, decided, interval, iqm, iqm_of_all

ODD_GAIT = "left-right-vertical"
OTHERS = tuple(gait for gait in GAITS if gait != ODD_GAIT)
ALIKE = 0.8
"""Of the best gait: the worst comes at least so far, where gaits are alike."""
SLOW = 0.9
"""Of the other gaits: who comes less far is slow."""


def gaits(alike_after: int, slow_after: int) -> tuple[Claim, Claim]:
    """Both claims, each after this practice [steps]."""
    return (
        Claim(
            "gaits-alike",
            "“All the walking gaits have pretty similar results, except for LeftRight-Vertical” "
            "(§5.1)",
            f"After {alike_after:,} steps the worst of the other three covers at least "
            f"{percent(ALIKE)} of the best.",
            partial(_alike, steps=alike_after),
        ),
        Claim(
            "odd-gait-slow",
            "LeftRight-Vertical “get[s] off to a slow start” (§5.1)",
            f"After {slow_after:,} steps it covers less than {percent(SLOW)} of what the other "
            "three do.",
            partial(_slow, steps=slow_after),
        ),
    )


def odd_against_others(case: Case, steps: int) -> Interval | None:
    """How far LeftRight-Vertical comes as a share of the other three gaits together."""
    odd, others = walked(case, ODD_GAIT, steps), _others(case, steps)
    if not odd or others is None or iqm_of_all(*map(np.asarray, others)) <= 0:
        return None

    def ratio(odd: FloatArray, *others: FloatArray, axis: int = -1) -> FloatArray:
        return iqm(odd, axis) / iqm_of_all(*others, axis=axis)

    return interval((odd, *others), ratio, case.seed)


def walked(case: Case, gait: str, steps: int) -> Points:
    """Every seed's total distance after this practice, in one go or in blocks [m]."""
    curve = case.curve(gait)
    if curve is not None and steps in curve["steps"]:
        return tuple(curve["points_m"][curve["steps"].index(steps)])
    setting = case.setting(gait, steps)
    once = setting is not None and setting["blocks"] == 1
    return tuple(setting["total"]["points_m"]) if setting is not None and once else ()


def _others(case: Case, steps: int) -> list[Points] | None:
    found = [walked(case, gait, steps) for gait in OTHERS]
    return found if all(found) else None


def _alike(case: Case, steps: int) -> Finding | None:
    others = _others(case, steps)
    if others is None:
        return None

    def worst_of_best(*walks: FloatArray, axis: int = -1) -> FloatArray:
        middles = np.stack([iqm(one, axis) for one in walks])
        return np.asarray(middles.min(axis=0) / middles.max(axis=0), dtype=np.float64)

    found = interval(others, worst_of_best, case.seed)
    middles = [float(iqm(np.asarray(points))) for points in others]
    return Finding.of(
        decided(found, ALIKE, min(map(len, others))),
        f"The other three cover {span(middles)} after "
        f"{steps:,} steps; the worst {shares(found)} of the best.",
    )


def _slow(case: Case, steps: int) -> Finding | None:
    found = odd_against_others(case, steps)
    if found is None:
        return None
    odd = walked(case, ODD_GAIT, steps)
    fewest = min(len(odd), *(len(walked(case, gait, steps)) for gait in OTHERS))
    return Finding.of(
        decided(-found, -SLOW, fewest),
        f"It covers {metres(float(iqm(np.asarray(odd))))} after {steps:,} steps, "
        f"{shares(found)} of the other three.",
    )
