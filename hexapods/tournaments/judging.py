"""Judge an entry on a draw: practice within the budget, then a race of 50 steps."""

from dataclasses import dataclass

from hexapods.domain.records import Record
from hexapods.runs.tables import Checkpoint
from hexapods.tournaments.entry import Entry
from hexapods.tournaments.rules import Draw, TournamentRules


@dataclass(frozen=True)
class Judgement(Record):
    """Result of an entry on a draw.

    Attributes:
        distance_m: that it walked in 50 steps from rest [m]; 0 if it failed.
        failure: why it failed, one sentence; None if it did not.
    """

    distance_m: float
    failure: str | None = None


def judge(
    rules: TournamentRules, entry: Entry, draw: Draw, table: Checkpoint | None = None
) -> Judgement:
    """Judge an entry on a draw; the same arguments give the same result, to the last bit.

    The draw's seed is that of practice and race, and draws the robot where there is a build
    tolerance; its world holds in both. Nobody is told the world: searchers plan with the nominal
    model. An agent that learns in races by default does here, too.

    Args:
        rules: of the tournament.
        entry: which they allow.
        draw: seed and world.
        table: what the entry has learned, if it enters with a table.

    Raises:
        HexapodError: if the entry is invalid.
    """
    raise NotImplementedError
