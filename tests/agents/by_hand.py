"""States, actions and transitions with which updates are computed by hand."""

from hexapods.agents.protocol import Problem, Transition
from hexapods.agents.tabular import TabularAgent
from hexapods.domain.grid import FootGrid
from hexapods.domain.observation import legal_actions
from hexapods.domain.types import Action, Cells

PROBLEM = Problem(((1, 4), (2, 5), (3, 6)), FootGrid().cells)
A, B, C = (0, 0, 0), (1, 0, 0), (1, 2, 0)
FIRST, SECOND, THIRD = Action(0, 1), Action(1, 2), Action(2, 3)
"""The actions that lead from A to B, and from B to C; and one in C."""


def step(
    before: Cells, action: Action, reward_m: float, after: Cells, then: Action | None = None
) -> Transition:
    return Transition(before, action, reward_m, after, legal_actions(after, 5), then)


def value(agent: TabularAgent, observation: Cells, action: Action) -> float:
    return float(agent.table.values(observation)[action])


def set_value(agent: TabularAgent, observation: Cells, action: Action, value: float) -> None:
    table = agent.table
    table.set_value(table.index(observation), table.column(action), value)
