"""The gait that the paper found odd."""

from collections.abc import Sequence

from app.experiments.claims.cases import PAPERS_AGENT, Case
from app.experiments.claims.gaits import ODD_GAIT, OTHERS, SLOW, odd_against_others
from app.experiments.formatting import listed, metres, shares, span
from app.experiments.published import published

AFTER = 500


def odd_gait(places: Sequence[Case]) -> str | None:
    """LeftRight-Vertical on each robot; nothing to say where the simulator knows no servos."""
    told = [_told(case) for case in places if case.simulator == "mujoco"]
    said = [one for one in told if one]
    if not said:
        return None
    return (
        "LeftRight-Vertical pairs the legs that stand opposite each other, so that both front legs "
        "leave the ground at once. Stiff servos hold the body level meanwhile; compliant ones let "
        "it pitch, and distance is lost.\n" + "\n".join([*said, _printed() + _slowed(places)])
    )


def _told(case: Case) -> str | None:
    greedy, rest = case.setting(ODD_GAIT, 0, "greedy"), _greedy_elsewhere(case)
    ratio = odd_against_others(case, AFTER)
    if greedy is None or not rest or ratio is None:
        return None
    return (
        f"With {case.label}, greedy covers {metres(greedy['total']['iqm_m'])} in this gait and "
        f"{span(rest)} in the other three; Q-learning after {AFTER} "
        f"steps covers {shares(ratio)} of what it does in the other three."
    )


def _greedy_elsewhere(case: Case) -> list[float]:
    found = [case.setting(gait, 0, "greedy") for gait in OTHERS]
    return [float(one["total"]["iqm_m"]) for one in found if one]


def _printed() -> str:
    learner, greedy = published(ODD_GAIT, PAPERS_AGENT, AFTER), published(ODD_GAIT, "greedy", 0)
    if learner is None or greedy is None:
        return ""
    return (
        f"The paper prints {learner.total_m:g} for Q-learning here, its smallest number of that "
        f"kind, but {greedy.total_m:g} for greedy, its largest."
    )


def _slowed(places: Sequence[Case]) -> str:
    """Where greedy loses in this gait too, our robot is not quite the paper's."""
    both = []
    for case in places:
        greedy, rest = case.setting(ODD_GAIT, 0, "greedy"), _greedy_elsewhere(case)
        if greedy and rest and greedy["total"]["iqm_m"] < SLOW * min(rest):
            both.append(case.robot)
    if not both:
        return ""
    robots = listed(dict.fromkeys(both))
    return (
        f" On our {robots} robot greedy is slow in this gait as well, in the paper only the "
        "learner: softer servos alone do not explain its numbers."
    )
