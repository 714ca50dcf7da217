"""Walkers on the kinematic simulator, with a search that is to be tested."""

from collections.abc import Callable

from app.agents.protocol import Agent
from app.domain.gait import resolve
from app.domain.grid import FootGrid
from app.domain.kinematic import KinematicSimulator
from app.domain.robot import Robot
from app.runs.walker import SimulatorExpand, Walker


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
