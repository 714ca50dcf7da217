"""What the paper hopes of tuning."""

from collections.abc import Mapping, Sequence
from typing import Any

from app.experiments.claims.cases import PAPERS_AGENT, Case
from app.experiments.claims.judging import Claim, Finding
from app.experiments.formatting import RATES as WORDS
from app.experiments.formatting import percent, shares
from app.experiments.statistics import CONFIDENCE, Points, decided, improvement
from app.runs.config import TrainingConfig

RATES = ("alpha", "gamma", "epsilon_start", "epsilon_end", "steps_per_episode")
_REST = ("steps", "divisions", "grid_side_m", "blocks")


def _tuning(case: Case) -> Finding | None:
    """The best of many is compared once, at a confidence that pays for having picked it."""
    ours = [
        one
        for one in case.pooled
        if one["agent"] == PAPERS_AGENT
        and one["relative"]
        and len(_seeds(case, one)) == len(one["gaits"])
    ]
    papers = [one for one in ours if _is_papers(one)]
    rivals = [one for one in ours if any(_comparable(one, own) for own in papers)]
    if not rivals:
        return None
    best = max(rivals, key=lambda one: float(one["relative"]["iqm"]))
    own = next(one for one in papers if _comparable(best, one))
    a, b = _seeds(case, best), _seeds(case, own)
    chance = improvement(a, b, case.seed, 1 - (1 - CONFIDENCE) / len(rivals))
    told = ", ".join(WORDS[name].format(best[name]) for name in RATES if best[name] != own[name])
    return Finding.of(
        decided(chance, 0.5, min(len(points) for points in (*a, *b))),
        f"The best of {len(rivals)} others ({told}) covers {shares(best['relative'])} of greedy, "
        f"the paper's values {shares(own['relative'])}; a seed of the best comes further with a "
        f"probability of {percent(chance.value)}.",
    )


def _is_papers(one: Mapping[str, Any]) -> bool:
    return all(one[name] == getattr(TrainingConfig, name) for name in RATES)


def _comparable(one: Mapping[str, Any], own: Mapping[str, Any]) -> bool:
    same = all(one[name] == own[name] for name in (*_REST, "gaits"))
    return same and not _is_papers(one)


def _seeds(case: Case, pool: Mapping[str, Any]) -> tuple[Points, ...]:
    """The distances of a pool's settings [m], gait by gait."""
    named = (*RATES, *_REST, "agent")
    return tuple(
        tuple(one["total"]["points_m"])
        for one in case.settings
        if one["total"] and all(one[name] == pool[name] for name in named)
    )


SWEEP_CLAIMS: Sequence[Claim] = (
    Claim(
        "tuning",
        "“It is very possible that tuning these parameters will result in faster Q-Learning” (§6)",
        "A seed with the best of the other values comes further than one with the paper's, after "
        "as much practice; the interval allows for having picked the best.",
        _tuning,
    ),
)
