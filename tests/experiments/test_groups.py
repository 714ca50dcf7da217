"""The claim on fewer groups, judged by made-up shares of greedy's distance."""

from collections.abc import Mapping
from typing import Any

import pytest

from hexapods.experiments.claims import CLAIMS
from hexapods.experiments.claims.cases import Case


def setting(gait: str, iqm: float, share: float, low: float, high: float) -> Mapping[str, Any]:
    return {
        "agent": "q-learning",
        "gait": gait,
        "steps": 250,
        "relative": {"iqm": iqm, "low": iqm, "high": iqm},
        "reaches_greedy": {"share": share, "low": low, "high": high},
    }


@pytest.mark.parametrize(
    ("low", "high", "verdict"),
    [(0.55, 0.9, "holds"), (0.4, 0.8, "not established"), (0.1, 0.4, "does not hold")],
)
def test_the_best_groups_decide(low: float, high: float, verdict: str) -> None:
    settings = [
        setting("left-right-origin", 0.57, 0.0, 0.0, 0.1),
        setting("tripod", 0.97, 0.6, low, high),
    ]
    case = Case("measured", "stiff", "", 0, "mujoco", (), settings, (), (), ())
    (claim,) = CLAIMS["groups"]
    finding = claim.find(case)

    assert finding is not None
    assert finding.verdict == verdict
    assert finding.evidence.startswith("After 250 steps, of greedy's distance: Tripod 97")
    assert "Left-right, opposite 57" in finding.evidence


def test_without_trials_nothing_is_judged() -> None:
    (claim,) = CLAIMS["groups"]
    assert claim.find(Case("measured", "stiff", "", 0, "mujoco", (), (), (), (), ())) is None
