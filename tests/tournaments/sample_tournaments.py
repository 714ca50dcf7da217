"""Small tournaments for tests: five draws, few steps."""

from collections.abc import Sequence
from functools import cache
from typing import Any

from hexapods.assembly import build_learner
from hexapods.runs.config import training_config
from hexapods.runs.tables import Checkpoint, from_bytes, snapshot, to_bytes
from hexapods.runs.training import train
from hexapods.tournaments.entry import EntryConfig, completed, references
from hexapods.tournaments.judging import judge
from hexapods.tournaments.rules import TournamentRules, draws_of
from hexapods.tournaments.tournament_file import (
    JudgedEntry,
    TournamentFile,
    sha256_of,
    tournament_file,
)

SECRET = "0123456789abcdef" * 4
GAIT = "left-right-origin"


def rules_of(**options: Any) -> TournamentRules:
    fields: dict[str, Any] = {"gait": GAIT, "simulator": "kinematic", "draws": 5, "steps": 60}
    return TournamentRules(**(fields | options))


@cache
def table_file(steps: int = 40, **options: Any) -> bytes:
    """Return the file of a table that Q-learning has learned in the kinematic simulator."""
    fields: dict[str, Any] = {"gait": GAIT, "simulator": "kinematic", **options}
    config = training_config("q-learning", steps=steps, evaluate_every=0, **fields)
    learner = build_learner(config)
    for _ in train(learner, config):
        pass
    return to_bytes(snapshot(learner, config))


def table_of(steps: int = 40, **options: Any) -> Checkpoint:
    return from_bytes(table_file(steps, **options), "q.npz")


def judged(
    rules: TournamentRules, entries: Sequence[EntryConfig], tables: Sequence[bytes] = ()
) -> TournamentFile:
    """Judge the references and some entries, and end the tournament."""
    by_digest = {sha256_of(table): from_bytes(table, "q.npz") for table in tables}
    every = [*references(rules), *(completed(entry, rules) for entry in entries)]
    return tournament_file(
        "A tournament",
        rules,
        SECRET,
        [
            JudgedEntry(
                number=number,
                name=f"entrant {number}",
                entry=entry,
                judgements=tuple(
                    judge(rules, entry, draw, by_digest.get(entry.table or ""))
                    for draw in draws_of(rules, SECRET)
                ),
            )
            for number, entry in enumerate(every)
        ],
        tables,
    )
