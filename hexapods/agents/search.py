"""Base class of agents that search: they plan by simulated transitions, and do not learn."""

from collections import Counter
from collections.abc import Sequence
from typing import Annotated

from annotated_types import Ge, Le

from hexapods.agents.explanation import Future
from hexapods.agents.protocol import AgentState, Expand, Problem, Transition
from hexapods.domain.errors import InvalidInput
from hexapods.domain.settings import Setting
from hexapods.domain.types import Action

MAX_TRANSITIONS = 40_000
"""Maximum of transitions that a search may simulate for one decision."""
Depth = Annotated[
    int,
    Ge(1),
    Le(50),
    Setting(title="Depth", help="How many steps it looks ahead.", examples=(2, 3)),
]
Width = Annotated[
    int,
    Ge(1),
    Le(1000),
    Setting(title="Width", help="How many sequences of steps it keeps.", examples=(2, 8)),
]
Budget = Annotated[
    int,
    Ge(1),
    Le(MAX_TRANSITIONS),
    Setting(
        title="Budget",
        unit="transitions",
        help="Most steps that it may simulate for one decision.",
        examples=(3, 40),
    ),
]


class Search:
    """Agent that learns and stores nothing; a subclass implements `act`.

    Args:
        expand: simulates transitions from the present state.
    """

    learns = False
    compares = "highest sum of the rewards of all sequences that begin with it"

    def __init__(self, expand: Expand) -> None:
        self._expand = expand
        self._futures: dict[Action, Future] = {}

    def futures(self) -> Sequence[Future]:
        """Return the reward and the return of each action simulated for the newest decision."""
        return tuple(self._futures.values())

    def _record_futures(
        self, firsts: Sequence[Action], sums_m: Sequence[float], steps: int
    ) -> None:
        """Store the highest sum of rewards for each first action, in place of shorter sequences'.

        Args:
            firsts: first action of each sequence.
            sums_m: sum of its rewards [m].
            steps: their number of steps; 1 begins a new decision.
        """
        if steps == 1:
            self._futures = {}
        best: dict[Action, float] = {}
        counts = Counter(firsts)
        for first, sum_m in zip(firsts, sums_m, strict=True):
            best[first] = max(sum_m, best.get(first, sum_m))
        for first, sum_m in best.items():
            future = self._futures.get(first)
            reward_m = sum_m if future is None else future.reward_m
            self._futures[first] = Future(first, reward_m, sum_m, counts[first], steps)

    def learn(self, transition: Transition) -> None:
        """Do nothing: the agent plans by simulation and does not learn."""

    def state(self) -> AgentState:
        """Return an empty state: a search stores nothing between decisions."""
        return {}

    def load(self, state: AgentState) -> None:
        """Do nothing."""


def action_count(problem: Problem) -> int:
    """Return the number of legal actions in each state."""
    return len(problem.groups) * (len(problem.cells_m) - 1)


def check_depth(depth: int, sizes: Sequence[int], actions: int) -> None:
    """Check that a search is not too large.

    Args:
        depth: its depth.
        sizes: transitions simulated for one decision, for the depths from 1 to `depth`.
        actions: number of actions in each state, for the message.

    Raises:
        InvalidInput: if it is larger than `MAX_TRANSITIONS`; the message names the highest depth.
    """
    if sizes[-1] > MAX_TRANSITIONS:
        most = max(1, sum(size <= MAX_TRANSITIONS for size in sizes))
        raise InvalidInput(
            f"depth {depth} would simulate more than {MAX_TRANSITIONS:,} transitions a decision, "
            f"with {actions} actions in each state; choose depth {most}"
            f"{' or less' if most > 1 else ''}, or fewer divisions"
        )
