"""Failed trials of an experiment, in words: for Python, the command line and the report."""

from collections.abc import Mapping, Sequence
from typing import Any

_MAX_REASONS = 3


def failed_trials(counts: Mapping[str, Any]) -> Sequence[Mapping[str, str]]:
    """Return key, label and reason of each trial without a distance, also of those set aside.

    Args:
        counts: `trials` of a summary.
    """
    return [*counts.get("failures", ()), *counts["set_aside"]]


def failures_text(counts: Mapping[str, Any]) -> str:
    """Return the number of failed trials in words: `2 of 5 trials failed`."""
    return f"{counts['failed']:,} of {counts['total']:,} trials failed"


def failures_sentence(counts: Mapping[str, Any]) -> str:
    """Return the number of failed trials, with one trial of each reason, in words; empty if 0."""
    if not counts["failed"]:
        return ""
    first: dict[str, str] = {}
    for trial in failed_trials(counts):
        first.setdefault(trial["reason"], trial["label"].replace("\N{NO-BREAK SPACE}", " "))
    reasons = [f"{label}: {reason}" for reason, label in first.items()]
    more = ["and for other reasons"] if len(reasons) > _MAX_REASONS else []
    return f"{failures_text(counts)}: {'; '.join([*reasons[:_MAX_REASONS], *more])}"
