"""Comparisons that a report has without a server: of pairs of its settings, with all sentences."""

from collections.abc import Mapping
from itertools import combinations
from typing import Any

from hexapods.experiments.setting_comparison import compare_settings

MAX_PAIRS = 60
"""Each takes about ten milliseconds; of more pairs those under the same conditions come first."""
_CONDITIONS = ("gait", "observation", "robot", "world", "divisions", "grid_side_m")


def compared_pairs(summary: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return comparisons of settings with distances: `keys` of both, and each as plain types."""
    walked = [entry for entry in summary["settings"] if entry["total"] is not None]
    pairs = list(combinations(walked, 2))
    if len(pairs) > MAX_PAIRS:
        pairs.sort(key=lambda pair: (not _have_same_conditions(*pair), not _are_learners(*pair)))
    return [
        {
            "keys": [a["key"], b["key"]],
            **compare_settings(summary, a["key"], b["key"]).as_json(),
        }
        for a, b in pairs[:MAX_PAIRS]
    ]


def _are_learners(a: Mapping[str, Any], b: Mapping[str, Any]) -> bool:
    return bool(a["role"] == b["role"] == "learner")


def _have_same_conditions(a: Mapping[str, Any], b: Mapping[str, Any]) -> bool:
    return all(a.get(name) == b.get(name) for name in _CONDITIONS)
