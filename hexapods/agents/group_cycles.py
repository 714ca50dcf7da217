"""Bandit over the order in which groups of legs move: short cycles, judged in blocks that double.

The reward of a cycle settles only after the feet have gone through it, so a cycle is judged by the
second half of a block. Blocks of the best cycle double after each challenger that earns less, as in
sequential halving (Karnin et al. 2013); a challenger is chosen by an upper confidence bound that
grows with the time since it was last tried (Auer et al. 2002).
"""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray

from hexapods.domain.settings import Setting
from hexapods.domain.types import FloatArray

Order = Annotated[
    Literal["turns", "cycles"],
    Setting(
        title="Order of the groups",
        phrase="order\u00a0{}",
        help="Order in which groups move: every one in turn, or the cycle that is found to pay, in "
        "which a group may move after each of the others.",
        choice_titles=("in turn", "learned cycles"),
    ),
]
Cycle = tuple[int, ...]
"""Groups in the order in which they move, again and again."""

_ROUNDS, _LONGEST = 2, 96
"""Rounds of a challenger's block; most steps of the best cycle's block."""
_MOST = 2**31
"""Limit of the numbers of blocks and steps of a state that is restored."""
_AGE = 0.03
"""Width of a bound, as a share of the law's reward, by √(blocks since the policy's last)."""
_UNTRIED_FURTHER, _UNTRIED_FREE = 0.8, 0.5
"""Reward per step that an untried policy is expected to earn, as a share of the law's: a cycle in
which a group moves more often than others, and one in which any group may move."""


def cycles_of(groups: int) -> list[Cycle]:
    """Return the cycles that are tried: every group once a round, or one after each of the others.

    Of three groups these are 012, 021, 0102, 0121 and 0212. Each begins with the lowest group.
    """
    forth = tuple(range(groups))
    back = (0, *reversed(forth[1:]))
    orders = [
        forth,
        back,
        *(
            tuple(step for other in forth if other != group for step in (group, other))
            for group in forth
            if groups > 1
        ),
    ]
    return list(dict.fromkeys(min(_rotations(order)) for order in orders))


def _rotations(cycle: Cycle) -> list[Cycle]:
    return [cycle[place:] + cycle[:place] for place in range(len(cycle))]


class CycleBandit:
    """Bandit over policies, each of a cycle or of free order, by the rewards of their steps.

    Args:
        cycles: cycle of each policy; None where any group may move.
        groups: number of groups of legs.
        law_m: reward per step of the steady walk without slip.

    Attributes:
        kept: the policy with the highest reward so far.
    """

    def __init__(self, cycles: Sequence[Cycle | None], groups: int, law_m: float) -> None:
        self._cycles, self._groups, self._law_m = tuple(cycles), groups, law_m
        self.kept = 0
        self._rewards_m: FloatArray = np.full(len(cycles), np.nan)
        """Reward per step of each policy in the second half of its last block; NaN if untried."""
        self._tried: FloatArray = np.zeros(len(cycles))
        """Number of blocks before each policy's last one."""
        self._blocks, self._length, self._taken, self._place = 0, 0, 0, 0
        self._judged_m, self._kept_steps = 0.0, self._least(0)

    def _least(self, policy: int) -> int:
        """Return the number of steps of a policy's first block."""
        return _ROUNDS * len(self._cycles[policy] or range(self._groups))

    @property
    def is_over(self) -> bool:
        """Whether the block has ended, and a policy is to be chosen."""
        return self._taken >= self._length

    def next_group(self, policy: int) -> int | None:
        """Return the group whose turn it is, and go on to the next; None if any may move."""
        self._taken += 1
        cycle = self._cycles[policy]
        if cycle is None:
            return None
        group = cycle[self._place % len(cycle)]
        self._place = (self._place + 1) % len(cycle)
        return group

    def earn(self, reward_m: float) -> None:
        """Add the reward of the last step, if that is in the second half of the block."""
        if self._taken > self._length // 2:
            self._judged_m += reward_m

    def choose(self, policy: int, last_group: int) -> int:
        """Judge the policy whose block has ended, and return the policy of the next block.

        Args:
            policy: the policy of the block that has ended.
            last_group: the group that moved last.
        """
        if self._length == 0:
            return self._begin(self.kept, self._least(self.kept), last_group)
        self._rewards_m[policy] = self._judged_m / (self._length - self._length // 2)
        self._tried[policy] = self._blocks
        self._blocks += 1
        if policy == self.kept:
            chosen = self._challenger()
            return self._begin(chosen, self._least(chosen), last_group)
        if self._rewards_m[policy] > self._rewards_m[self.kept]:
            self.kept = policy
            return self._begin(policy, 2 * self._least(policy), last_group)
        self._kept_steps = min(2 * self._kept_steps, _LONGEST)
        round_steps = self._least(self.kept) // _ROUNDS
        length = -(-self._kept_steps // round_steps) * round_steps  # whole rounds
        return self._begin(self.kept, length, last_group)

    def restart(self, policy: int, last_group: int) -> None:
        """Drop all rewards after a change of the robot or the ground; `policy` continues."""
        self.kept, self._rewards_m[:] = policy, np.nan
        self._kept_steps = self._least(policy)
        self._begin(policy, self._least(policy), last_group)

    def walk_from_rest(self) -> int:
        """Return the policy of a frozen copy: the kept one, from the beginning of its cycle."""
        self._place = 0
        return self.kept

    def _begin(self, policy: int, length: int, last_group: int) -> int:
        """Begin a block, in which a cycle goes on after the group that moved last."""
        self._length, self._taken, self._judged_m = length, 0, 0.0
        cycle = self._cycles[policy] or ()
        self._place = cycle.index(last_group) + 1 if last_group in cycle else 0
        return policy

    def _challenger(self) -> int:
        """Return the policy of the highest bound; the kept one if no bound exceeds its reward."""
        ages = np.sqrt(self._blocks - self._tried)
        bounds_m = self._rewards_m + _AGE * self._law_m * ages
        for policy in np.flatnonzero(np.isnan(bounds_m)).tolist():
            bounds_m[policy] = self._untried_m(policy)
        bounds_m[self.kept] = self._rewards_m[self.kept]
        return int(bounds_m.argmax()) if bounds_m.max() > bounds_m[self.kept] else self.kept

    def _untried_m(self, policy: int) -> float:
        cycle = self._cycles[policy]
        if cycle is None:
            return _UNTRIED_FREE * self._law_m
        return np.inf if len(cycle) == self._groups else _UNTRIED_FURTHER * self._law_m

    def dump(self) -> dict[str, FloatArray]:
        """Return the state as named arrays."""
        counts = (self.kept, self._blocks, self._length, self._taken, self._place, self._kept_steps)
        return {
            "cycle_rewards": self._rewards_m.copy(),
            "cycle_tried": self._tried.copy(),
            "cycle_judged": np.array([self._judged_m]),
            "cycle_counts": np.array(counts, float),
        }

    @staticmethod
    def check(arrays: Mapping[str, NDArray[Any]], policies: int) -> None:
        """Check the bandit's arrays in a saved state, if it has any.

        Raises:
            KeyError, ValueError: if the arrays are not those of a bandit with so many policies.
        """
        if "cycle_rewards" not in arrays:
            return
        for name, size in (
            ("rewards", policies),
            ("tried", policies),
            ("judged", 1),
            ("counts", 6),
        ):
            array = arrays[f"cycle_{name}"]
            if array.shape != (size,) or array.dtype.kind != "f" or np.isinf(array).any():
                raise ValueError(f"its cycle_{name} are no {size} numbers")
        counts = arrays["cycle_counts"]
        numbers = (
            *arrays["cycle_tried"].tolist(),
            *arrays["cycle_judged"].tolist(),
            *counts.tolist(),
        )
        if np.isnan(numbers).any() or (counts < 0).any() or (counts != counts.round()).any():
            raise ValueError("its cycle_counts are no whole numbers")
        if counts[0] >= policies or counts.max() > _MOST:
            raise ValueError("its cycle_counts are out of range")

    def load(self, arrays: Mapping[str, FloatArray]) -> None:
        """Restore the state from the arrays that `dump` returned."""
        self._rewards_m, self._tried = arrays["cycle_rewards"].copy(), arrays["cycle_tried"].copy()
        (self._judged_m,) = arrays["cycle_judged"].tolist()
        self.kept, self._blocks, self._length, *rest = map(int, arrays["cycle_counts"].tolist())
        self._taken, self._place, self._kept_steps = rest
