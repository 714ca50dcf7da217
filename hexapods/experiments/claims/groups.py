"""The paper's claim that Q-learning soon comes level with greedy, with other groups of legs."""

from collections.abc import Sequence

from hexapods.experiments.claims.cases import PAPERS_AGENT, Case
from hexapods.experiments.claims.judging import CaseFinding, Claim
from hexapods.experiments.formatting import percent, shares
from hexapods.experiments.labels import gait_name
from hexapods.experiments.presets import REACHED_SHARE
from hexapods.experiments.statistics import Interval

HALF = 0.5


def _is_level(case: Case) -> CaseFinding | None:
    """Judge the fewest groups: the gait with the highest share of greedy's distance."""
    learned = [
        setting
        for setting in case.settings
        if setting["agent"] == PAPERS_AGENT and setting["relative"]
    ]
    if not learned:
        return None
    ordered = sorted(learned, key=lambda setting: -float(setting["relative"]["iqm"]))
    descriptions = [
        f"{gait_name(setting['gait'])} {shares(setting['relative'])}, "
        f"{percent(setting['reaches_greedy']['share'])} of the seeds reach {percent(REACHED_SHARE)}"
        for setting in ordered
    ]
    best = ordered[0]
    return CaseFinding.of(
        Interval.of(best["reaches_greedy"]).exceeds(HALF),
        f"After {best['steps']:,} steps, of greedy's distance: {'; '.join(descriptions)}.",
    )


GROUPS_CLAIMS: Sequence[Claim] = (
    Claim(
        "level",
        "“on par with greedy search algorithms often in less than 500 steps” (§4)",
        "In the gait in which it comes farthest, more than half of the seeds reach "
        f"{percent(REACHED_SHARE)} of greedy's distance.",
        _is_level,
    ),
)
