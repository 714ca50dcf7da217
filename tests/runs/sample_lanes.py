"""Builders of small hand-made lanes, for expected values that are easy to compute."""

from collections.abc import Sequence

import numpy as np

from hexapods.domain.simulator import Motion
from hexapods.domain.types import Action
from hexapods.runs.recording import LaneRecording
from hexapods.runs.records import LaneStep


def qpos(y: float) -> list[float]:
    """Return a pose at y [m] along the track: upright, with one joint whose angle depends on y."""
    return [0, y, 0.1, 1, 0, 0, 0, 10 * y]


def step(
    number: int,
    ys: Sequence[float],
    *,
    transitions: int = 0,
    decision_s: float = 0.0,
    frame_s: float = 0.5,
) -> LaneStep:
    """Return a step whose position is ys[0], ys[1], … [m] after frame_s, 2 frame_s, … [s]."""
    times = np.arange(1, len(ys) + 1) * frame_s
    motion = Motion(times.astype(np.float32), np.array([qpos(y) for y in ys], np.float32))
    return LaneStep(
        0, number, (0, 0, 0), Action(0, 1), 0.0, ys[-1], transitions, decision_s, motion, None
    )


def lane(*steps: LaneStep, agent: str = "greedy", failure: str | None = None) -> LaneRecording:
    return LaneRecording(agent, np.array(qpos(0), np.float32), list(steps), failure)
