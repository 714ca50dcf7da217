"""What Table 1 shows."""

from collections.abc import Callable, Mapping, Sequence
from statistics import fmean, median
from typing import Any

from app.experiments.claims.cases import PAPERS_AGENT, Case
from app.experiments.claims.distance_to_paper import near, nearer
from app.experiments.formatting import (
    counted,
    distance,
    gait_name,
    listed,
    metres,
    percent,
    shares,
)
from app.experiments.narrative.gaits import odd_gait
from app.experiments.statistics import Points, improvement

Settings = list[Any]


def one_seed(places: Sequence[Case]) -> str | None:
    """The spread of one setting, and how often a single seed names the wrong winner."""
    learners = _learners(places)
    if not learners:
        return None
    one = max(learners, key=lambda s: max(s["total"]["points_m"]) - min(s["total"]["points_m"]))
    first = learners[0]
    at = next(case.label for case in places if first in case.settings)
    points = first["total"]["points_m"]
    said = [
        f"A printed number is one run of a learner that throws dice. {gait_name(first['gait'])} "
        f"after {first['steps']:,} steps, with {at}: the middle is {distance(first['total'])}, "
        f"but of {counted(first['n'], 'seed')} the worst covers {metres(min(points))} and the best "
        f"{metres(max(points))}. "
        f"The widest spread of all settings is {metres(min(one['total']['points_m']))} to "
        f"{metres(max(one['total']['points_m']))}."
    ]
    settled = [s["beats_greedy"] for s in learners if s["beats_greedy"]]
    shares_ = [b["share"] for b in settled if b["verdict"] != "not established"]
    if shares_:
        wrong = fmean(min(share, 1 - share) for share in shares_)
        worst = max(min(share, 1 - share) for share in shares_)
        said.append(
            f"In {len(shares_)} of {len(settled)} settings the seeds together settle who is "
            "ahead when the race ends, Q-learning or greedy; one seed alone would name the wrong "
            f"one in {percent(wrong)} of cases, and in {percent(worst)} in the worst of these "
            f"settings. In the other {len(settled) - len(shares_)} the seeds do not settle it, "
            "and yet one seed would name a winner."
        )
    return "\n".join([*said, *_backwards(places)])


def _backwards(places: Sequence[Case]) -> list[str]:
    case = places[0]
    gaits = dict.fromkeys(s["gait"] for s in case.settings)
    both = [(case.setting(g, 500), case.setting(g, 1000)) for g in gaits]
    pairs = [(_points(a), _points(b)) for a, b in both if a and b]
    if not pairs:
        return []
    chance = improvement(tuple(a for a, _ in pairs), tuple(b for _, b in pairs), case.seed)
    return [
        f"With {case.label}, one run after 500 steps and one after 1,000 would show that more "
        f"practice makes it worse with a probability of {shares(chance)}."
    ]


def readings(places: Sequence[Case]) -> str | None:
    """How much the two readings differ, and which comes nearer to what was printed."""
    by_robot: dict[str, list[Case]] = {}
    for case in places:
        by_robot.setdefault(case.robot, []).append(case)
    said = []
    for robot, pair in by_robot.items():
        pools = [(case, case.pool(1000)) for case in pair]
        shown = [
            f"{shares(pool['relative'])} with {_reading(case)} "
            f"({percent(pool['walkers']['share'])} of the seeds walk)"
            for case, pool in pools
            if pool and pool["relative"]
        ]
        if len(shown) == 2:
            told = (
                f"On the {robot} robot Q-learning covers, of greedy's distance after 1,000 "
                f"steps, {listed(shown)}."
            )
            said.append(" ".join([told, *_which_is_nearer(pair)]))
    if not said:
        return None
    return (
        "The paper does not say whether the robot reads back where its feet are, or remembers "
        "where it sent them. The algorithm is the same; only what it sees differs. "
        + "\n".join(["", *said])
    )


def _reading(case: Case) -> str:
    return case.label.partition(" (")[0]


def _which_is_nearer(pair: Sequence[Case]) -> list[str]:
    a, b = pair
    close, verdict = [near(one) for one in pair], nearer(a, b)
    if close[0] is None or close[1] is None or verdict is None:
        return []
    counts = [
        f"{one.inside} of the {one.of} printed distances lie within the central 95 % of the seeds "
        f"with {_reading(one.case)}, {metres(one.apart_m)} from our middle on average"
        for one in close
        if one
    ]
    who = {"yes": a, "no": b}.get(verdict[0])
    last = (
        f"The printed numbers are nearer to those with {_reading(who)}."
        if who
        else "Which reading is nearer to the printed numbers is not established."
    )
    return [f"{'; '.join(counts)}. {last}"]


def text_against_table(places: Sequence[Case]) -> str | None:
    """Where the paper's text says that Q-learning beats greedy, and where its table does."""
    gaits = ("left-right-origin", "front-back-origin")
    said = []
    for case in places:
        found = [case.setting(gait, 1000) for gait in gaits]
        shown = [
            f"{shares(one['beats_greedy'])} in {gait_name(one['gait'])} "
            f"({_VERDICTS[one['beats_greedy']['verdict']]})"
            for one in found
            if one and one["beats_greedy"]
        ]
        if len(shown) == 2:
            said.append(f"With {case.label}: {listed(shown)}.")
    if not said:
        return None
    return (
        "The text says that after 1,000 trials Q-learning beats greedy in LeftRight-Origin, by "
        "finished distance. The table has it behind there (0.325 against 0.375), and ahead in "
        "FrontBack-Origin (0.375 against 0.35). One of the two is a slip, and we take the table. "
        "The share of our seeds that are ahead:\n" + "\n".join(said)
    )


def clocks(places: Sequence[Case]) -> str | None:
    """The paper clock, the wall clock, and what each does to the race."""
    timed = [one["lanes"] for case in places for one in case.timed]
    times = {
        agent: [
            one["elapsed_s"]
            for case in places
            for one in case.settings
            if one["agent"] == agent and one["elapsed_s"]
        ]
        for agent in ("greedy", "two-step")
    }
    if not timed or not all(times.values()):
        return None
    thought = {
        agent: median(
            lane["decision_s"] for lanes in timed for lane in lanes if lane["agent"] == agent
        )
        for agent in ("greedy", "two-step")
    }
    walks = median(lane["elapsed_s"] - lane["decision_s"] for lanes in timed for lane in lanes)
    first = sum(lanes[0]["rank"] == 1 for lanes in timed)
    return (
        f"Everyone takes 50 steps, {walks:.0f} s of walking. What differs is the thinking. The "
        "paper clock charges for every simulated future what the paper's greedy agent must have "
        f"paid: greedy then ends after {median(times['greedy']):.0f} s and two-step after "
        f"{median(times['two-step']):.0f} s. On this machine, timed alone, greedy thought "
        f"{thought['greedy']:.2g} s and two-step {thought['two-step']:.2g} s. By that wall clock "
        f"Q-learning was ahead at the finish in {first} of {counted(len(timed), 'timed race')} "
        "after 500 steps of practice. Finished distance depends on who computes how fast; total "
        "distance does not."
    )


def _learners(places: Sequence[Case]) -> Settings:
    return [
        one
        for case in places
        for one in case.settings
        if one["agent"] == PAPERS_AGENT and one["n"] > 1
    ]


def _points(setting: Mapping[str, Any]) -> Points:
    return tuple(setting["total"]["points_m"])


_VERDICTS = {"yes": "more than half", "no": "fewer than half", "not established": "not established"}

TABLE1_STORY: Sequence[tuple[str, Callable[[Sequence[Case]], str | None]]] = (
    ("One seed misleads", one_seed),
    ("Two readings of the same robot", readings),
    ("Why LeftRight-Vertical is the odd one", odd_gait),
    ("Where the paper's text and table disagree", text_against_table),
    ("Whose clock?", clocks),
)
