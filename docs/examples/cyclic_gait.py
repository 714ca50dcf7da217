"""A cyclic gait on the foot grid, by which the examples of evolutionary search walk."""

from collections.abc import Sequence

import hexapods as hx


class CyclicGait:
    """Sends the groups of legs to cells in a fixed order, again and again.

    A group that stands on its cell already is passed over, as the robot has no such action; if all
    do, the first legal action is taken.
    """

    def __init__(self, cycle: Sequence[hx.Action]) -> None:
        self.cycle, self.next = list(cycle), 0

    def act(self, legal: Sequence[hx.Action]) -> hx.Action:
        """Return the next action of the cycle that is legal."""
        for ahead in range(len(self.cycle)):
            number = (self.next + ahead) % len(self.cycle)
            if self.cycle[number] in legal:
                self.next = number + 1
                return self.cycle[number]
        return legal[0]
