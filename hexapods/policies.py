"""Policies from outside: any function from an observation to an action, for a lane of a race."""

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from hexapods.agents import registry
from hexapods.agents.protocol import AgentState, Problem, Transition
from hexapods.domain.errors import IllegalAction, InvalidInput
from hexapods.domain.observation import action_mask
from hexapods.domain.text import NAMES, check_name
from hexapods.domain.types import Action, Cells

_MAX_SHOWN = 100


@dataclass(frozen=True)
class Policy:
    """A function that chooses actions, as `policy` returns it.

    Attributes:
        predict: the function.
        name: of its lane, in place of an agent's name.
    """

    predict: Callable[..., Any]
    name: str


def policy(predict: Callable[..., Any], *, name: str | None = None) -> Policy:
    """Return a policy for `race` and `lane`: a function that chooses actions, such as a model's.

    It sees and answers what the Gymnasium environment does. It is called with the observation
    alone, an array with the observed cell of each group of legs, and returns the number of a legal
    action, group × cells + cell, or a tuple that begins with it, as `predict` of Stable-Baselines3
    does. One with a parameter `action_masks`, such as that of MaskablePPO, also gets an array with
    True for each action that is legal. `race` raises what it raises, and `IllegalAction` if what it
    returns is no legal action.

    Args:
        predict: the function; `functools.partial(model.predict, deterministic=True)` is one, too.
        name: of its lane; by default that of the function, or of the class of its object.

    Raises:
        InvalidInput: if it is no function, or the name is not valid.

    Examples:
        >>> import hexapods as hx
        >>> import numpy as np
        >>> def lowest_legal(observation, action_masks):
        ...     return int(np.flatnonzero(action_masks)[0])
        >>> lanes = [hx.policy(lowest_legal, name="Lowest"), "greedy"]
        >>> race = hx.race(lanes, simulator="kinematic", steps=6)
        >>> [standing.agent for standing in race.standings]
        ['greedy', 'Lowest']
    """
    if not callable(predict):
        raise InvalidInput(f"a policy is a function such as model.predict, not {predict!r}")
    chosen: object = _name_of(predict) if name is None else name
    if not isinstance(chosen, str) or ":" in chosen or not chosen.strip():
        raise InvalidInput(f"a policy's name is {NAMES}, and without a colon; not {chosen!r}")
    chosen = check_name(chosen)
    if chosen in registry.registered():
        raise InvalidInput(f"{chosen!r} is the name of an agent; give the policy another name")
    return Policy(predict, chosen)


def _name_of(predict: Any) -> str:
    function = getattr(predict, "func", predict)  # of a `functools.partial`
    owner = getattr(function, "__self__", None)
    name = getattr(function, "__name__", type(function).__name__)
    if owner is not None and not inspect.ismodule(owner):
        name = owner.__name__ if isinstance(owner, type) else type(owner).__name__
    return "policy" if name == "<lambda>" else str(name)


class PolicyAgent:
    """Agent that asks a policy.

    Attributes:
        error: that the policy has raised, or that what it returned is no legal action; None if
            there is none.
    """

    learns = False

    def __init__(self, policy: Policy, problem: Problem) -> None:
        self.error: Exception | None = None
        self._policy = policy
        self._groups, self._cells = len(problem.groups), len(problem.cells_m)
        self._takes_mask = _takes_mask(policy.predict)

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        """Return the action that the policy chooses.

        Raises:
            IllegalAction: if it is none, or not legal.
        """
        cells = np.array(observation, np.int64)
        masks = {"action_masks": action_mask(legal, self._groups, self._cells)}
        try:
            answer = self._policy.predict(cells, **(masks if self._takes_mask else {}))
            return self._legal_action(answer, observation, legal)
        except Exception as error:
            self.error = error
            raise

    def _legal_action(self, answer: Any, observation: Cells, legal: Sequence[Action]) -> Action:
        number = np.asarray(answer[0] if isinstance(answer, tuple) and answer else answer)
        count = self._groups * self._cells
        if number.size != 1 or number.dtype.kind not in "iu" or not 0 <= number.item() < count:
            shown = repr(answer)
            raise IllegalAction(
                f"{self._policy.name} returned {shown[:_MAX_SHOWN]}, which is no action: an action "
                f"is a whole number from 0 to {count - 1}, group × {self._cells} + cell"
            )
        action = Action(*divmod(int(number.item()), self._cells))
        if action not in legal:
            numbers = ", ".join(str(group * self._cells + cell) for group, cell in legal)
            raise IllegalAction(
                f"{self._policy.name} chose action {number.item()}, group {action.group + 1} to "
                f"cell {action.cell}, which is not legal where the groups are observed in cells "
                f"{list(observation)}; legal are {numbers}. A function with a parameter "
                "action_masks is given them"
            )
        return action

    def learn(self, transition: Transition) -> None:
        """Do nothing."""

    def state(self) -> AgentState:
        """Return nothing: what a policy knows is its own."""
        return {}

    def load(self, state: AgentState) -> None:
        """Do nothing."""


def _takes_mask(predict: Callable[..., Any]) -> bool:
    try:
        return "action_masks" in inspect.signature(predict).parameters
    except (TypeError, ValueError):  # of a function that is not written in Python
        return False
