"""The paragraph about left-right, mirrored, which differs from the paper's other gaits."""

from collections.abc import Sequence

from hexapods.domain.text import metres
from hexapods.experiments.claims.cases import PAPERS_AGENT, Case
from hexapods.experiments.claims.gaits import ODD_GAIT, OTHER_GAITS, SLOW_RATIO, odd_gait_ratio
from hexapods.experiments.formatting import listed, shares, span
from hexapods.experiments.labels import gait_name_with_papers
from hexapods.experiments.published import published

STEPS = 500
_ODD_GAIT_NAME = gait_name_with_papers(ODD_GAIT)
ODD_GAIT_HEADING = f"Why {_ODD_GAIT_NAME} is the odd one"


def explain_odd_gait(cases: Sequence[Case]) -> str | None:
    """Describe left-right, mirrored on each robot.

    None for the kinematic simulator, which models no servos.
    """
    descriptions = [_describe_case(case) for case in cases if case.simulator == "mujoco"]
    sentences = [sentence for sentence in descriptions if sentence]
    if not sentences:
        return None
    return (
        f"{_ODD_GAIT_NAME} moves each leg with its mirror image, so that both front legs "
        "leave the ground at once. Stiff servos hold the body level meanwhile; compliant ones let "
        "it pitch, and distance is lost.\n"
        + "\n".join([*sentences, _printed_numbers() + _greedy_slow_too(cases)])
    )


def _describe_case(case: Case) -> str | None:
    greedy, rest = case.setting(ODD_GAIT, 0, "greedy"), _greedy_in_other_gaits(case)
    ratio = odd_gait_ratio(case, STEPS)
    if greedy is None or not rest or ratio is None:
        return None
    return (
        f"With {case.label}, greedy covers {metres(greedy['total']['iqm_m'])} in this gait and "
        f"{span(rest)} in the other three; Q-learning after {STEPS} "
        f"steps covers {shares(ratio)} of what it does in the other three."
    )


def _greedy_in_other_gaits(case: Case) -> list[float]:
    settings = [case.setting(gait, 0, "greedy") for gait in OTHER_GAITS]
    return [float(setting["total"]["iqm_m"]) for setting in settings if setting]


def _printed_numbers() -> str:
    learner, greedy = published(ODD_GAIT, PAPERS_AGENT, STEPS), published(ODD_GAIT, "greedy", 0)
    if learner is None or greedy is None:
        return ""
    return (
        f"The paper prints {learner.total_m:g} for Q-learning here, its smallest number of that "
        f"kind, but {greedy.total_m:g} for greedy, its largest."
    )


def _greedy_slow_too(cases: Sequence[Case]) -> str:
    """Name the robots on which greedy is slow in this gait too, unlike in the paper."""
    slow_robots = []
    for case in cases:
        greedy, rest = case.setting(ODD_GAIT, 0, "greedy"), _greedy_in_other_gaits(case)
        if greedy and rest and greedy["total"]["iqm_m"] < SLOW_RATIO * min(rest):
            slow_robots.append(case.robot)
    if not slow_robots:
        return ""
    robots = listed(dict.fromkeys(slow_robots))
    return (
        f" On our {robots} robot greedy is slow in this gait as well, in the paper only the "
        "learner: softer servos alone do not explain its numbers."
    )
