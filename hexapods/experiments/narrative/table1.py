"""Paragraphs about Table 1."""

from collections.abc import Callable, Mapping, Sequence
from statistics import fmean, median
from typing import Any

from hexapods.domain.observation import PAPER_OBSERVATIONS
from hexapods.domain.text import counted, metres
from hexapods.experiments.claims.cases import PAPERS_AGENT, Case
from hexapods.experiments.claims.distance_to_paper import closeness, compare_closeness
from hexapods.experiments.formatting import distance, listed, percent, shares
from hexapods.experiments.labels import gait_name, gait_name_with_papers
from hexapods.experiments.narrative.gaits import ODD_GAIT_HEADING, explain_odd_gait
from hexapods.experiments.statistics import Points, improvement

Settings = list[Any]


def describe_seed_spread(cases: Sequence[Case]) -> str | None:
    """Describe the seeds' spread, and how often a single seed would name the wrong winner."""
    learners = _learners(cases)
    if not learners:
        return None
    widest = max(learners, key=lambda s: max(s["total"]["points_m"]) - min(s["total"]["points_m"]))
    first = learners[0]
    at = next(case.label for case in cases if first in case.settings)
    points = first["total"]["points_m"]
    sentences = [
        f"A printed number is one run of a learner that throws dice. {gait_name(first['gait'])} "
        f"after {first['steps']:,} steps, with {at}: the middle is {distance(first['total'])}, "
        f"but of {counted(first['n'], 'seed')} the worst covers {metres(min(points))} and the best "
        f"{metres(max(points))}. "
        f"The widest spread of all settings is {metres(min(widest['total']['points_m']))} to "
        f"{metres(max(widest['total']['points_m']))}."
    ]
    comparisons = [s["beats_greedy"] for s in learners if s["beats_greedy"]]
    decided_shares = [b["share"] for b in comparisons if b["verdict"] != "not established"]
    if decided_shares:
        wrong = fmean(min(share, 1 - share) for share in decided_shares)
        worst = max(min(share, 1 - share) for share in decided_shares)
        sentences.append(
            f"In {len(decided_shares)} of {len(comparisons)} settings the seeds together settle "
            "who is ahead when the race ends, Q-learning or greedy; one seed alone would name the "
            f"wrong one in {percent(wrong)} of cases, and in {percent(worst)} in the worst of "
            f"these settings. In the other {len(comparisons) - len(decided_shares)} the seeds do "
            "not settle it, and yet one seed would name a winner."
        )
    return "\n".join([*sentences, *_more_practice_worse(cases)])


def _more_practice_worse(cases: Sequence[Case]) -> list[str]:
    case = cases[0]
    gaits = dict.fromkeys(s["gait"] for s in case.settings)
    gait_settings = [(case.setting(g, 500), case.setting(g, 1000)) for g in gaits]
    pairs = [(_points(a), _points(b)) for a, b in gait_settings if a and b]
    if not pairs:
        return []
    chance = improvement(tuple(a for a, _ in pairs), tuple(b for _, b in pairs), case.seed)
    return [
        f"With {case.label}, one run after 500 steps and one after 1,000 would show that more "
        f"practice makes it worse with a probability of {shares(chance)}."
    ]


def compare_observations(cases: Sequence[Case]) -> str | None:
    """Compare the paper's two observations; name the one closer to the printed numbers."""
    by_robot: dict[str, list[Case]] = {}
    for case in cases:
        if case.observation in PAPER_OBSERVATIONS:
            by_robot.setdefault(case.robot, []).append(case)
    sentences = []
    for robot, pair in by_robot.items():
        pools = [(case, case.pool(1000)) for case in pair]
        phrases = [
            f"{shares(pool['relative'])} with {_observation_label(case)} "
            f"({percent(pool['walkers']['share'])} of the seeds walk)"
            for case, pool in pools
            if pool and pool["relative"]
        ]
        if len(phrases) == 2:
            sentence = (
                f"On the {robot} robot Q-learning covers, of greedy's distance after 1,000 "
                f"steps, {listed(phrases)}."
            )
            sentences.append(" ".join([sentence, *_describe_nearer(pair)]))
    if not sentences:
        return None
    return (
        "The paper does not say whether the robot measures where its feet are, or remembers "
        "where it sent them. The algorithm is the same; only what it sees differs. "
        + "\n".join(["", *sentences])
    )


def _observation_label(case: Case) -> str:
    return case.label.partition(" (")[0]


def _describe_nearer(pair: Sequence[Case]) -> list[str]:
    a, b = pair
    close, verdict = [closeness(case) for case in pair], compare_closeness(a, b)
    if close[0] is None or close[1] is None or verdict is None:
        return []
    counts = [
        f"{comparison.inside} of the {comparison.compared} printed distances lie within the "
        f"central 95 % of the seeds with {_observation_label(comparison.case)}, "
        f"{metres(comparison.mean_error_m)} from our middle on average"
        for comparison in close
        if comparison
    ]
    nearer_case = {"yes": a, "no": b}.get(verdict[0])
    last = (
        f"The printed numbers are nearer to those with {_observation_label(nearer_case)}."
        if nearer_case
        else "Which reading is nearer to the printed numbers is not established."
    )
    return [f"{'; '.join(counts)}. {last}"]


def compare_text_with_table(cases: Sequence[Case]) -> str | None:
    """Compare the gait in which the paper's text has Q-learning beat greedy with its table's."""
    gaits = ("left-right-origin", "front-back-origin")
    sentences = []
    for case in cases:
        settings = [case.setting(gait, 1000) for gait in gaits]
        phrases = [
            f"{shares(setting['beats_greedy'])} in {gait_name(setting['gait'])} "
            f"({_VERDICTS[setting['beats_greedy']['verdict']]})"
            for setting in settings
            if setting and setting["beats_greedy"]
        ]
        if len(phrases) == 2:
            sentences.append(f"With {case.label}: {listed(phrases)}.")
    if not sentences:
        return None
    return (
        "The text says that after 1,000 trials Q-learning beats greedy in "
        f"{gait_name_with_papers(gaits[0])}, by distance at time-out. The table has it behind "
        f"there (0.325 against 0.375), and ahead in {gait_name_with_papers(gaits[1])} (0.375 "
        "against 0.35). One of the two is a slip, and we take the table. The share "
        "of our seeds that are ahead:\n" + "\n".join(sentences)
    )


def compare_clocks(cases: Sequence[Case]) -> str | None:
    """Compare the paper clock with times measured on this machine, and their effect on races."""
    timed = [race["lanes"] for case in cases for race in case.timed]
    times = {
        agent: [
            setting["elapsed_s"]
            for case in cases
            for setting in case.settings
            if setting["agent"] == agent and setting["elapsed_s"]
        ]
        for agent in ("greedy", "two-step")
    }
    if not timed or not all(times.values()):
        return None
    thinking_s = {
        agent: median(
            lane["decision_s"] for lanes in timed for lane in lanes if lane["agent"] == agent
        )
        for agent in ("greedy", "two-step")
    }
    walking_s = median(lane["elapsed_s"] - lane["decision_s"] for lanes in timed for lane in lanes)
    first = sum(lanes[0]["rank"] == 1 for lanes in timed)
    return (
        f"Everyone takes 50 steps, {walking_s:.0f} s of walking. What differs is the thinking. The "
        "paper clock charges for every simulated future what the paper's greedy agent must have "
        f"paid: greedy then ends after {median(times['greedy']):.0f} s and two-step after "
        f"{median(times['two-step']):.0f} s. On this machine, timed alone, greedy thought "
        f"{thinking_s['greedy']:.2g} s and two-step {thinking_s['two-step']:.2g} s. By that wall "
        f"clock Q-learning was ahead at time-out in {first} of {counted(len(timed), 'timed race')} "
        "after 500 steps of practice. Distance at time-out depends on who computes how fast; "
        "total distance does not."
    )


def _learners(cases: Sequence[Case]) -> Settings:
    return [
        setting
        for case in cases
        for setting in case.settings
        if setting["agent"] == PAPERS_AGENT and setting["n"] > 1
    ]


def _points(setting: Mapping[str, Any]) -> Points:
    return tuple(setting["total"]["points_m"])


_VERDICTS = {"yes": "more than half", "no": "fewer than half", "not established": "not established"}

TABLE1_NARRATIVE: Sequence[tuple[str, Callable[[Sequence[Case]], str | None]]] = (
    ("One seed misleads", describe_seed_spread),
    ("Two readings of the same robot", compare_observations),
    (ODD_GAIT_HEADING, explain_odd_gait),
    ("Where the paper's text and table disagree", compare_text_with_table),
    ("Whose clock?", compare_clocks),
)
