"""Walkers on the kinematic simulator, with a search that is to be tested."""

from collections.abc import Callable

from hexapods.agents.protocol import Agent
from hexapods.domain.gait import resolve
from hexapods.domain.grid import FootGrid
from hexapods.domain.kinematic import KinematicSimulator
from hexapods.domain.robot import Robot
from hexapods.runs.walker import SimulatorExpand, Walker


def kinematic_walker(
    search: Callable[[SimulatorExpand], Agent],
    gait: str = "left-right-origin",
    divisions: int = 2,
) -> tuple[Walker, SimulatorExpand]:
    """Return a walker at rest, and the simulator that its agent looks ahead with."""
    simulator = KinematicSimulator(
        Robot(), resolve(gait, Robot().azimuths_deg), FootGrid(divisions=divisions)
    )
    expand = SimulatorExpand(simulator, "measured")
    return Walker(simulator, search(expand), "measured", expand), expand
