"""The paper's claims about its Table 1."""

from collections.abc import Mapping
from functools import partial
from statistics import fmean, median
from typing import Any

from hexapods.domain.sums import ordered_sum
from hexapods.domain.text import counted, metres
from hexapods.experiments.claims.cases import PAPERS_AGENT, Case
from hexapods.experiments.claims.gaits import gait_claims
from hexapods.experiments.claims.judging import CaseFinding, Claim
from hexapods.experiments.formatting import distance, listed, percent, shares
from hexapods.experiments.labels import gait_name_with_papers
from hexapods.experiments.presets import REACHED_SHARE
from hexapods.experiments.published import GAITS, published
from hexapods.experiments.statistics import Interval, Verdict, bootstrap_exceeds

AFTER = (500, 1000)


def _dominates(case: Case) -> CaseFinding | None:
    raced = [
        setting
        for setting in case.settings
        if setting["agent"] == PAPERS_AGENT and setting["n"] and setting["beats_greedy_total"]
    ]
    if not raced:
        return None
    verdicts = {setting["beats_greedy_total"]["verdict"] for setting in raced}
    verdict: Verdict = (
        "no" if "yes" in verdicts else "yes" if verdicts == {"no"} else ("not established")
    )
    pools = [(steps, case.pool(steps)) for steps in AFTER]
    shares_of_greedy = [
        f"{shares(pool['relative'])} of greedy's total after {steps:,} steps"
        for steps, pool in pools
        if pool and pool["relative"]
    ]
    n = sum(setting["n"] for setting in raced)  # whole numbers
    wins = ordered_sum(setting["n"] * setting["beats_greedy_total"]["share"] for setting in raced)
    return CaseFinding.of(
        verdict,
        f"Q-learning covers {listed(shares_of_greedy)}; {wins:.0f} of its {counted(n, 'walk')} "
        "came further than greedy.",
    )


def _real_time(case: Case, steps: int) -> CaseFinding | None:
    pool = case.pool(steps)
    if pool is None or pool["relative_finished"] is None:
        return None
    relative = pool["relative_finished"]
    fewest = min(setting["n"] for setting in case.settings if setting["steps"] == steps)
    return CaseFinding.of(
        bootstrap_exceeds(Interval.of(relative), REACHED_SHARE, fewest),
        f"When Q-learning has taken its 50 steps it has come {shares(relative)} as far as greedy, "
        f"and {percent(pool['beats_greedy']['share'])} of the walks are ahead. The paper's own "
        f"four gaits average {percent(_papers_share(steps))}.",
    )


def _papers_share(steps: int) -> float:
    """Return Q-learning's share of greedy's printed distance at time-out, averaged over gaits."""
    pairs = ((published(g, PAPERS_AGENT, steps), published(g, "greedy", 0)) for g in GAITS)
    return fmean(q.finished_m / greedy.finished_m for q, greedy in pairs if q and greedy)


def _beats(case: Case, gait: str) -> CaseFinding | None:
    q, greedy = case.setting(gait, AFTER[1]), case.setting(gait, 0, "greedy")
    if q is None or greedy is None or q["beats_greedy"] is None:
        return None
    return CaseFinding.of(
        q["beats_greedy"]["verdict"],
        f"{shares(q['beats_greedy'])} of {counted(q['n'], 'seed')} are ahead of greedy: "
        f"{distance(q['finished'])} against {metres(greedy['finished']['iqm_m'])}. "
        f"{_papers_race(gait)}",
    )


def _papers_race(gait: str) -> str:
    q, greedy = published(gait, PAPERS_AGENT, AFTER[1]), published(gait, "greedy", 0)
    if q is None or greedy is None:
        return ""
    return f"The paper's table has {q.finished_m:g} against {greedy.finished_m:g}."


def _on_par(case: Case) -> CaseFinding | None:
    pool = case.pool(AFTER[0])
    if pool is None or pool["reaches_greedy"] is None:
        return None
    reached = pool["reaches_greedy"]
    finished = pool["beats_greedy"]
    also = f" At time-out {percent(finished['share'])} are ahead of greedy." if finished else ""
    return CaseFinding.of(
        Interval.of(reached).exceeds(0.5),
        f"After 500 steps {shares(reached)} of {counted(pool['n'], 'walk')} reach "
        f"{percent(REACHED_SHARE)} of greedy's total distance.{also}",
    )


def _two_step(case: Case) -> CaseFinding | None:
    thinks = [_thinking(race["lanes"]) for race in case.timed]
    if not thinks:
        return None
    slowest, fastest = max(share for share, _ in thinks), min(share for share, _ in thinks)
    verdict: Verdict = "yes" if fastest > 1 else "no" if slowest < 1 else "not established"
    seconds = median(decided_s for _, decided_s in thinks)
    return CaseFinding.of(
        verdict,
        f"On this machine two-step thought {seconds:.2g} s in 50 steps, between "
        f"{percent(fastest)} and {percent(slowest)} of the time that it walked, in "
        f"{counted(len(thinks), 'timed race')}."
        f"{_by_the_paper(case)}",
    )


def _thinking(lanes: list[Mapping[str, Any]]) -> tuple[float, float]:
    """Return two-step's decision time as a share of its walking time, and in seconds."""
    lane = next(lane for lane in lanes if lane["agent"] == "two-step")
    return lane["decision_s"] / (lane["elapsed_s"] - lane["decision_s"]), lane["decision_s"]


def _by_the_paper(case: Case) -> str:
    times = {
        agent: [
            setting["elapsed_s"]
            for setting in case.settings
            if setting["agent"] == agent and setting["n"]
        ]
        for agent in ("greedy", "two-step")
    }
    if not all(times.values()):
        return ""
    return (
        f" Under the paper clock, fitted to its greedy agent, two-step's 50 steps take "
        f"{median(times['two-step']):.0f} s and greedy's {median(times['greedy']):.0f} s."
    )


TABLE1_CLAIMS: tuple[Claim, ...] = (
    Claim(
        "greedy-dominates",
        "“Greedy dominates the Q-Learning in total distance” (§5.1)",
        "In every gait, after 500 and after 1,000 steps, most seeds end behind greedy.",
        _dominates,
    ),
    *(
        Claim(
            f"real-time-{steps}",
            f"“Q-Learning walks just as fast in real time” (§5.1), after {steps:,} steps",
            f"Distance at time-out at least {percent(REACHED_SHARE)} of greedy's, over all gaits, "
            "under the paper clock.",
            partial(_real_time, steps=steps),
        )
        for steps in AFTER
    ),
    Claim(
        "text-beats-greedy",
        "“beats the Greedy Agent for the LeftRight-Origin walking gait after 1000 trials” (§5.1, "
        "text)",
        "More than half of the seeds are ahead at time-out.",
        partial(_beats, gait="left-right-origin"),
    ),
    Claim(
        "table-beats-greedy",
        f"{gait_name_with_papers('front-back-origin')} is where Q-learning beats greedy after "
        "1,000 trials (Table 1, against the text)",
        "More than half of the seeds are ahead at time-out.",
        partial(_beats, gait="front-back-origin"),
    ),
    Claim(
        "on-par-500",
        "“on par with greedy search algorithms often in less than 500 steps” (§4)",
        f"After 500 steps more than half of the seeds reach {percent(REACHED_SHARE)} of greedy's "
        "total distance.",
        _on_par,
    ),
    Claim(
        "two-step-slow",
        "“Two-Step Agents are impractically slow to calculate” (§5.1)",
        "On this machine it thinks longer than it walks, in every timed race.",
        _two_step,
    ),
    *gait_claims(alike_after=1000, slow_after=500),
)
