"""Small graphs for searches, made by hand, that count what is simulated."""

from collections.abc import Mapping, Sequence

import numpy as np

from hexapods.agents.protocol import Node
from hexapods.domain.types import Action, FloatArray

World = Mapping[str, Sequence[tuple[str, float]]]
"""For each place its steps: where they lead, and the reward [m]."""


class Place:
    """Node of a graph, whose actions are (0, 0), (0, 1), …"""

    def __init__(self, name: str, world: World) -> None:
        self.name, self._world = name, world

    @property
    def legal(self) -> Sequence[Action]:
        return tuple(Action(0, cell) for cell in range(len(self._world[self.name])))

    @property
    def offsets_m(self) -> Sequence[tuple[float, float]]:
        return ((0.0, 0.0),)


class Graph:
    """`Expand` on a graph, from its place A.

    Attributes:
        calls: number of transitions of each call.
        visited: where each transition led.
    """

    def __init__(self, world: World) -> None:
        self._world = world
        self.here: Node = Place("A", world)
        self.calls: list[int] = []
        self.visited: list[str] = []

    def __call__(
        self, nodes: Sequence[Node], actions: Sequence[Action]
    ) -> tuple[Sequence[Node], FloatArray]:
        self.calls.append(len(actions))
        children = [
            self._world[node.name][action.cell]  # type: ignore[attr-defined]
            for node, action in zip(nodes, actions, strict=True)
        ]
        self.visited += [name for name, _ in children]
        return [Place(name, self._world) for name, _ in children], np.array(
            [r for _, r in children]
        )
