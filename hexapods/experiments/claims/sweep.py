"""The paper's expectation that tuning its parameters makes Q-learning faster."""

from collections.abc import Mapping, Sequence
from typing import Any

from hexapods.domain.settings import Value
from hexapods.experiments.claims.cases import PAPERS_AGENT, Case
from hexapods.experiments.claims.judging import CaseFinding, Claim
from hexapods.experiments.formatting import percent, shares
from hexapods.experiments.labels import parameter_text
from hexapods.experiments.statistics import CONFIDENCE, Points, bootstrap_exceeds, improvement
from hexapods.runs.config import TrainingConfig, agent_settings

PARAMETERS: Mapping[str, Value] = {
    **{name: setting.default for name, setting in agent_settings(PAPERS_AGENT).items()},
    "steps_per_episode": TrainingConfig.steps_per_episode,
}
"""The paper's values of what a sweep varies."""
_REST = ("steps", "divisions", "grid_side_m", "blocks")


def _tuning(case: Case) -> CaseFinding | None:
    """Compare the best of the other parameter values with the paper's.

    The confidence level has a Bonferroni correction for selecting the best of several candidates.
    """
    learned = [
        pool
        for pool in case.pooled
        if pool["agent"] == PAPERS_AGENT
        and pool["relative"]
        and len(_seeds(case, pool)) == len(pool["gaits"])
    ]
    papers = [pool for pool in learned if _is_papers(pool)]
    candidates = [
        pool for pool in learned if any(_comparable(pool, papers_pool) for papers_pool in papers)
    ]
    if not candidates:
        return None
    best = max(candidates, key=lambda pool: float(pool["relative"]["iqm"]))
    papers_pool = next(pool for pool in papers if _comparable(best, pool))
    a, b = _seeds(case, best), _seeds(case, papers_pool)
    chance = improvement(a, b, case.seed, 1 - (1 - CONFIDENCE) / len(candidates))
    values = ", ".join(
        parameter_text(name, best[name], PAPERS_AGENT)
        for name in PARAMETERS
        if best[name] != papers_pool[name]
    )
    return CaseFinding.of(
        bootstrap_exceeds(chance, 0.5, min(len(points) for points in (*a, *b))),
        f"The best of {len(candidates)} others ({values}) covers {shares(best['relative'])} of "
        f"greedy, the paper's values {shares(papers_pool['relative'])}; a seed of the best comes "
        f"further with a probability of {percent(chance.value)}.",
    )


def _is_papers(pool: Mapping[str, Any]) -> bool:
    return all(pool[name] == value for name, value in PARAMETERS.items())


def _comparable(pool: Mapping[str, Any], papers_pool: Mapping[str, Any]) -> bool:
    same = all(pool[name] == papers_pool[name] for name in (*_REST, "gaits"))
    return same and not _is_papers(pool)


def _seeds(case: Case, pool: Mapping[str, Any]) -> tuple[Points, ...]:
    """Return the seeds' distances [m] of a pool's settings, one tuple per gait."""
    named = (*PARAMETERS, *_REST, "agent")
    return tuple(
        tuple(setting["total"]["points_m"])
        for setting in case.settings
        if setting["total"] and all(setting[name] == pool[name] for name in named)
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
