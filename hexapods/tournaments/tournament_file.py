"""Tournaments that have ended as files, which anyone can repeat to the last digit."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from hexapods.domain.records import Record
from hexapods.tournaments.entry import Entry
from hexapods.tournaments.judging import Judgement
from hexapods.tournaments.ranking import Standing
from hexapods.tournaments.rules import TournamentRules

FORMAT = 1
MEDIA_TYPE = "application/json"


@dataclass(frozen=True, kw_only=True)
class JudgedEntry(Record):
    """An entry with its judgements.

    Attributes:
        number: from 0, in the order of their entering; the references come first.
        name: of its entrant, or of the reference.
        entry: as it was judged.
        judgements: on each draw, in their order.
    """

    number: int
    name: str
    entry: Entry
    judgements: tuple[Judgement, ...]


@dataclass(frozen=True, kw_only=True)
class TournamentFile(Record):
    """A tournament that has ended, complete: what is needed to repeat it, and what came of it.

    Attributes:
        format: of the file.
        title: of the tournament.
        rules: its rules.
        commitment: of the secret, which was published at the beginning.
        secret: from which the draws follow.
        entries: that were judged on all draws.
        standings: best first.
        tables: by SHA-256 the trained tables, as base64 of their files.
        robots: by id the documents of stored robots that rules or entries name.
        versions: of the packages on which the results depend.
        machine: on which it was judged.
    """

    format: int = FORMAT
    title: str
    rules: TournamentRules
    commitment: str
    secret: str
    entries: tuple[JudgedEntry, ...]
    standings: tuple[Standing, ...]
    tables: Mapping[str, str] = field(default_factory=dict)
    robots: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    versions: Mapping[str, str] = field(default_factory=dict)
    machine: Mapping[str, Any] = field(default_factory=dict)


def write_file(tournament: TournamentFile) -> bytes:
    """Encode a tournament as JSON."""
    raise NotImplementedError


def read_file(data: bytes, name: str) -> TournamentFile:
    """Decode a tournament.

    Args:
        data: content of the file.
        name: of the file, for messages.

    Raises:
        DamagedFile: if it is no tournament of this product, or of a later format.
    """
    raise NotImplementedError


def verify(
    tournament: TournamentFile,
    workers: int | None = None,
    on_judged: Callable[[int, int], object] = lambda done, total: None,  # noqa: ARG005
) -> list[str]:
    """Repeat a tournament, and return what differs, a sentence each; nothing if all is the same.

    Args:
        tournament: the tournament.
        workers: number of processes; None for one per core.
        on_judged: called with how many draws of entries have been judged, and of how many.
    """
    raise NotImplementedError
