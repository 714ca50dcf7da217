"""Presses of + and − of those who watch a training: checked, recorded in its changes, applied.

A change of a training with `presses` is a list of [steps done in the picture, value from −1 to 1],
as `hexapods.agents.protocol.Press` has them.
"""

import math
from collections.abc import Sequence
from typing import Any, cast

from hexapods.agents import registry
from hexapods.agents.protocol import Agent, Press, Teachable
from hexapods.domain.errors import InvalidInput
from hexapods.runs.config import MAX_STEPS

MAX_PRESSES = 100
"""Most presses of one change."""
RecordedPresses = list[list[float]]
_VALID = (
    f"presses is a list of 1 to {MAX_PRESSES} pairs: steps done in the picture, from 0 to "
    f"{MAX_STEPS:,}, and a value from -1 to 1, such as [[12.4, 1], [13.1, -0.5]]"
)


def teachable_agents() -> list[str]:
    """Return the names of the registered agents that learn from presses."""
    return [name for name in registry.registered() if _is_teachable(name)]


def check_teachable(agent: str) -> None:
    """Check that an agent learns from presses.

    Raises:
        UnknownName, InvalidInput: if there is no such agent, or it does not.
    """
    if not _is_teachable(agent):
        names = ", ".join(teachable_agents())
        raise InvalidInput(f"{agent} does not learn from presses; those that do: {names}")


def _is_teachable(agent: str) -> bool:
    return hasattr(registry.find(agent), "feel")


def read_presses(value: object, agent: str) -> RecordedPresses:
    """Return presses as they are recorded, checked.

    Args:
        value: a list of pairs, untrusted.
        agent: name of the agent of the training.

    Raises:
        InvalidInput: if they are none, or the agent does not learn from presses.
    """
    check_teachable(agent)
    if not isinstance(value, list | tuple) or not 1 <= len(value) <= MAX_PRESSES:
        raise InvalidInput(_VALID)
    return [_read(press) for press in value]


def _read(press: object) -> list[float]:
    if not isinstance(press, list | tuple) or len(press) != 2 or not all(map(_is_number, press)):
        raise InvalidInput(_VALID)
    at_step, value = map(float, cast(Sequence[Any], press))
    if not (0 <= at_step <= MAX_STEPS and -1 <= value <= 1):
        raise InvalidInput(_VALID)
    return [at_step, value]


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def apply_presses(agent: Agent | object, presses: Sequence[Sequence[float]]) -> None:
    """Let an agent learn from recorded presses, if it learns from presses."""
    if isinstance(agent, Teachable):
        agent.feel([Press(at_step, value) for at_step, value in presses])
