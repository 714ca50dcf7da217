"""The paper's claims about its gaits: three are alike, and one is slow."""

from functools import partial

import numpy as np

from hexapods.domain.text import metres
from hexapods.domain.types import FloatArray
from hexapods.experiments.claims.cases import Case
from hexapods.experiments.claims.judging import CaseFinding, Claim
from hexapods.experiments.formatting import percent, shares, span
from hexapods.experiments.labels import gait_name_with_papers
from hexapods.experiments.published import GAITS
from hexapods.experiments.statistics import (
    Interval,
    Points,
    bootstrap_exceeds,
    interval,
    iqm,
    pooled_iqm,
)

ODD_GAIT = "left-right-vertical"
OTHER_GAITS = tuple(gait for gait in GAITS if gait != ODD_GAIT)
ALIKE_RATIO = 0.8
"""Gaits count as alike if the worst covers at least this share of the best one's distance."""
SLOW_RATIO = 0.9
"""A gait counts as slow if it covers less than this share of the others' distance."""


def gait_claims(alike_after: int, slow_after: int) -> tuple[Claim, Claim]:
    """Build both claims, each for its steps of practice."""
    return (
        Claim(
            "gaits-alike",
            "“All the walking gaits have pretty similar results, except for LeftRight-Vertical” "
            "(§5.1)",
            f"After {alike_after:,} steps the worst of the other three covers at least "
            f"{percent(ALIKE_RATIO)} of the best.",
            partial(_alike, steps=alike_after),
        ),
        Claim(
            "odd-gait-slow",
            f"{gait_name_with_papers(ODD_GAIT)} “get[s] off to a slow start” (§5.1)",
            f"After {slow_after:,} steps it covers less than {percent(SLOW_RATIO)} of what the "
            "other three do.",
            partial(_slow, steps=slow_after),
        ),
    )


def odd_gait_ratio(case: Case, steps: int) -> Interval | None:
    """Return the distance of left-right, mirrored as a share of the other three gaits' together."""
    odd, other_gaits = (
        total_distances(case, ODD_GAIT, steps),
        _distances_of_other_gaits(case, steps),
    )
    if not odd or other_gaits is None or pooled_iqm(*map(np.asarray, other_gaits)) <= 0:
        return None

    def ratio(odd: FloatArray, *other_gaits: FloatArray, axis: int = -1) -> FloatArray:
        return iqm(odd, axis) / pooled_iqm(*other_gaits, axis=axis)

    return interval((odd, *other_gaits), ratio, case.seed)


def total_distances(case: Case, gait: str, steps: int) -> Points:
    """Return every seed's total distance after steps of practice, in one or several blocks [m]."""
    curve = case.curve(gait)
    if curve is not None and steps in curve["steps"]:
        return tuple(curve["points_m"][curve["steps"].index(steps)])
    setting = case.setting(gait, steps)
    once = setting is not None and setting["blocks"] == 1
    return tuple(setting["total"]["points_m"]) if setting is not None and once else ()


def _distances_of_other_gaits(case: Case, steps: int) -> list[Points] | None:
    walks = [total_distances(case, gait, steps) for gait in OTHER_GAITS]
    return walks if all(walks) else None


def _alike(case: Case, steps: int) -> CaseFinding | None:
    distances = _distances_of_other_gaits(case, steps)
    if distances is None:
        return None

    def worst_of_best(*walks: FloatArray, axis: int = -1) -> FloatArray:
        middles = np.stack([iqm(walk, axis) for walk in walks])
        return np.asarray(middles.min(axis=0) / middles.max(axis=0), dtype=np.float64)

    ratio = interval(distances, worst_of_best, case.seed)
    middles = [float(iqm(np.asarray(points))) for points in distances]
    return CaseFinding.of(
        bootstrap_exceeds(ratio, ALIKE_RATIO, min(map(len, distances))),
        f"The other three cover {span(middles)} after "
        f"{steps:,} steps; the worst {shares(ratio)} of the best.",
    )


def _slow(case: Case, steps: int) -> CaseFinding | None:
    ratio = odd_gait_ratio(case, steps)
    if ratio is None:
        return None
    odd = total_distances(case, ODD_GAIT, steps)
    fewest = min(len(odd), *(len(total_distances(case, gait, steps)) for gait in OTHER_GAITS))
    return CaseFinding.of(
        bootstrap_exceeds(-ratio, -SLOW_RATIO, fewest),
        f"It covers {metres(float(iqm(np.asarray(odd))))} after {steps:,} steps, "
        f"{shares(ratio)} of the other three.",
    )
