"""Names of the moves of a walking problem."""

from app.features.explanations.response_models import WalkedGrid
from hexapods.domain.types import Action
from hexapods.runs.config import WalkingProblem


class ActionNames:
    """Names of the actions and states of a walking problem."""

    def __init__(self, walk: WalkingProblem) -> None:
        self._groups, self._grid = walk.resolved_gait.groups, walk.grid

    def move(self, action: Action) -> str:
        """Return the name of an action: "legs 1 and 4 to front left"."""
        legs = " and ".join(map(str, self._groups[action.group]))
        return f"legs {legs} to {self._grid.name(action.cell)}"

    @property
    def grid(self) -> WalkedGrid:
        """The groups of legs and the cells of the foot grid."""
        return WalkedGrid(
            pairs=[list(group) for group in self._groups],
            cells_m=[(x_m, y_m) for x_m, y_m in self._grid.cells.round(5).tolist()],
            cell_names=[self._grid.name(cell) for cell in range(len(self._grid))],
        )
