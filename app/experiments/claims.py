"""Which of the paper's claims hold over many seeds, as far as the intervals say."""

from collections.abc import Mapping
from typing import Any


def judge(summary: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Every claim that this experiment can answer."""
    return []
