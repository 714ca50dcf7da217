"""Judge an entry on a draw: practice within the budget, then a race of 50 steps."""

import math
from dataclasses import dataclass, replace

from hexapods.agents.registry import keeps_learning, learns, searches
from hexapods.domain.errors import HexapodError, IllegalAction, InvalidInput
from hexapods.domain.records import Record
from hexapods.domain.text import message
from hexapods.domain.world import parse_world
from hexapods.experiments.trial import TrialConfig, run_trial
from hexapods.runs.tables import Checkpoint
from hexapods.tournaments.entry import EntryConfig, check_table, training_of
from hexapods.tournaments.rules import Draw, TournamentRules


@dataclass(frozen=True)
class Judgement(Record):
    """Result of an entry on a draw.

    Attributes:
        distance_m: that it walked in 50 steps from rest [m]; 0 if it failed.
        failure: why it failed, one sentence; None if it did not.

    Raises:
        InvalidInput: if the distance is no number, or that of a failed one is not 0.
    """

    distance_m: float
    failure: str | None = None

    def __post_init__(self) -> None:
        if not math.isfinite(self.distance_m):
            raise InvalidInput(f"distance_m must be a finite number, not {self.distance_m}")
        if self.failure is not None and self.distance_m != 0.0:
            raise InvalidInput(f"distance_m of a failed draw must be 0, not {self.distance_m!r}")


def judge(
    rules: TournamentRules, entry: EntryConfig, draw: Draw, table: Checkpoint | None = None
) -> Judgement:
    """Judge an entry on a draw; the same arguments give the same result, to the last bit.

    The draw's seed is that of practice and race, and draws the robot where there is a build
    tolerance; its world holds in both. No agent is told the world: searchers plan with the nominal
    model. An agent that learns in races by default does here, too. What a trained table has
    learned on another robot or in another simulator may race here: it is judged by how far it
    walks.

    Physics that diverges, an agent that raises, or a search that simulates more than the
    rules allow, is a judgement with a failure and 0 m.

    Args:
        rules: of the tournament.
        entry: which they allow.
        draw: seed and world.
        table: what the entry has learned, if it enters with a table.

    Raises:
        HexapodError: if the rules do not allow the entry or its table.
    """
    if (table is None) != (entry.table is None):
        raise InvalidInput("an entry is judged with its table if it has one, and else without")
    if table is not None:
        check_table(entry, rules, table)
    training = replace(training_of(entry, rules), seed=draw.seed, world=parse_world(draw.world))
    trial = TrialConfig(
        training=training,
        blocks=int(table is None and learns(entry.agent)),
        plans_with="nominal" if searches(entry.agent) else None,
        keep_learning=keeps_learning(entry.agent),
        most_transitions=rules.transitions,
    )
    try:
        result = run_trial(trial, table=table)
    except IllegalAction as error:
        return _failed(str(error))
    except (HexapodError, MemoryError):
        raise
    except Exception as error:  # an agent of a package may raise anything while it practises
        return _failed(f"{entry.agent} failed: {type(error).__name__}: {error}")
    if result.failure is not None:
        return _failed(result.failure)
    return Judgement(result.distances_m[0])


def _failed(reason: str) -> Judgement:
    return Judgement(0.0, message(reason))
