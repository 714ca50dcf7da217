"""Tournaments that have ended as files, which anyone can repeat to the last digit."""

import hashlib
import json
from base64 import b64decode, b64encode
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NoReturn

from hexapods.assembly import build_walkers
from hexapods.domain import robot_documents
from hexapods.domain.checks import check_format
from hexapods.domain.errors import (
    DamagedFile,
    HexapodError,
    InvalidInput,
    OtherFormat,
    TooLong,
)
from hexapods.domain.json_lists import check_lists
from hexapods.domain.records import Record, from_json, to_json
from hexapods.domain.robot import parse_document
from hexapods.domain.robot_library import LIBRARY, RobotLibrary
from hexapods.domain.text import check_name, visible
from hexapods.domain.world import parse_world
from hexapods.experiments.worker import versions
from hexapods.machine import description, instructions
from hexapods.runs.config import RACE_STEPS
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.racing import record_race
from hexapods.tournaments.entry import EntryConfig, completed, training_of
from hexapods.tournaments.judging import Judgement
from hexapods.tournaments.ranking import RankedEntry, ranking
from hexapods.tournaments.rules import (
    MAX_ENTRIES,
    Draw,
    TournamentRules,
    commitment_of,
    draws_of,
)

FORMAT = 1
MEDIA_TYPE = "application/json"
MAX_BYTES = 48 << 20
"""Size of a file; most have a few MB, and reading one takes up to ten times as much memory."""
PROBE = "random_walk_m"
_MAX_REASON = 1_000


@dataclass(frozen=True, kw_only=True)
class JudgedEntry(Record):
    """An entry with its judgements.

    Attributes:
        number: number from 0, in the order of entering; the references come first.
        name: name of its entrant, or of the reference.
        entry: config of the entry, as it was judged.
        judgements: judgement on each draw, in the order of draws.

    Raises:
        InvalidInput: if the name is not valid.
    """

    number: int
    name: str
    entry: EntryConfig
    judgements: tuple[Judgement, ...]

    def __post_init__(self) -> None:
        check_name(self.name)


@dataclass(frozen=True, kw_only=True)
class TournamentFile(Record):
    """A tournament that has ended, complete: all data to repeat it, and its results.

    Attributes:
        format: version of the file's format.
        title: title of the tournament.
        rules: rules of the tournament.
        commitment: commitment to the secret, which was published at the beginning.
        secret: secret from which the draws follow.
        entries: entries that were judged on all draws.
        standings: ranked entries, best first.
        tables: the trained tables by SHA-256, as base64 of their files.
        robots: documents of stored robots that rules or entries name, by id.
        versions: versions of the packages on which the results depend, and the processor's kind.
        machine: machine on which it was judged, and as `PROBE` the result of `probe_m` on it.

    Raises:
        InvalidInput: if the title is not valid, or the entries are not numbered ascending.
    """

    format: int = FORMAT
    title: str
    rules: TournamentRules
    commitment: str
    secret: str
    entries: tuple[JudgedEntry, ...]
    standings: tuple[RankedEntry, ...]
    tables: Mapping[str, str] = field(default_factory=dict)
    robots: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    versions: Mapping[str, str] = field(default_factory=dict)
    machine: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        check_name(self.title)
        if len(self.entries) > MAX_ENTRIES:
            raise InvalidInput(
                f"a tournament has at most {MAX_ENTRIES} entries, not {len(self.entries)}"
            )
        numbers = [entry.number for entry in self.entries]
        if numbers != sorted(set(numbers)):
            raise InvalidInput("the entries of a tournament are numbered ascending")

    def table(self, digest: str) -> bytes | None:
        """Return the file of a trained table by its SHA-256; None if it is not there."""
        text = self.tables.get(digest)
        return None if text is None else b64decode(text)


def tournament_file(
    title: str,
    rules: TournamentRules,
    secret: str,
    entries: Sequence[JudgedEntry],
    tables: Iterable[bytes] = (),
) -> TournamentFile:
    """Return a tournament that has ended, with its standings and all data to repeat it.

    Args:
        title: title of the tournament.
        rules: rules of the tournament.
        secret: secret from which the draws follow.
        entries: entries that were judged on all draws, ascending by their numbers.
        tables: files of the trained tables that entered.

    Raises:
        InvalidInput: if a name is not valid.
    """
    return TournamentFile(
        title=title,
        rules=rules,
        commitment=commitment_of(secret),
        secret=secret,
        entries=tuple(entries),
        standings=tuple(standings_of({entry.number: entry.judgements for entry in entries})),
        tables={sha256_of(table): b64encode(table).decode() for table in tables},
        robots={
            robot_documents.id_of(robot.document.data): json.loads(robot.document.data)
            for robot in (rules.robot, *rules.robots)
            if robot.document is not None
        },
        versions=own_versions(),
        machine={**description(), PROBE: probe_m(rules, draws_of(rules, secret)[0])},
    )


def own_versions() -> dict[str, str]:
    """Return the versions and kind of processor here, on which a tournament's results depend."""
    return {**versions(), "processor": instructions()}


def probe_m(rules: TournamentRules, draw: Draw) -> list[float]:
    """Return the distances of the random walk after each of its steps on a draw [m].

    Where a tournament does not repeat to the last bit, the distances show the first step that
    differs: the random walk's decisions depend on no measurement.
    """
    training = replace(
        training_of(completed(EntryConfig(agent="random-walk"), rules), rules),
        seed=draw.seed,
        world=parse_world(draw.world),
    )
    lanes = (LaneConfig(agent=training.agent, observation=training.observation),)
    race = RaceConfig(**vars(training.walk()), lanes=lanes, steps=RACE_STEPS, seed=training.seed)
    *_, [lane] = record_race(build_walkers(race, [None], threads=1), race, lambda: 0.0)
    distances_m: list[float] = lane.steps.figures["distance_m"].tolist()
    return distances_m


def standings_of(judgements: Mapping[int, Sequence[Judgement]]) -> list[RankedEntry]:
    """Return the standings of entries by their judgements, by number; best first."""
    return ranking(
        {
            number: [judgement.distance_m for judgement in judged]
            for number, judged in judgements.items()
        },
        {
            number: sum(judgement.failure is not None for judgement in judged)
            for number, judged in judgements.items()
        },
    )


def sha256_of(table: bytes) -> str:
    """Return the SHA-256 of a table's file, by which entries name it."""
    return hashlib.sha256(table).hexdigest()


def write_file(tournament: TournamentFile) -> bytes:
    """Encode a tournament as JSON.

    Raises:
        TooLong: if `read_file` would not read it, as it is too large.
    """
    data = json.dumps(to_json(tournament), allow_nan=False, indent=1).encode()
    if len(data) > MAX_BYTES:
        raise TooLong(
            f"the file of a tournament has at most {MAX_BYTES:,} bytes, not {len(data):,}"
        )
    return data


def read_file(data: bytes, name: str) -> TournamentFile:
    """Decode a tournament. `hexapods.tournaments.verification` checks whether it repeats.

    Args:
        data: content of the file.
        name: name of the file, for messages.

    Raises:
        OtherFormat: if it is of another version.
        DamagedFile: if it is no tournament of this product, or one of its tables or robots is not
            what its name says.
    """
    try:
        library = RobotLibrary(LIBRARY, _robots(_checked(data, name)))
        tournament = from_json(TournamentFile, data, strict=True, context=library)
        _check_tables(tournament)
    except OtherFormat:
        raise
    except (HexapodError, ValueError, TypeError, AttributeError, RecursionError) as error:
        reason = "it is nested too deeply" if isinstance(error, RecursionError) else str(error)
        raise DamagedFile(
            f"{name} is no tournament that can be read: {visible(reason)[:_MAX_REASON]}"
        ) from error
    return tournament


def _checked(data: bytes, name: str) -> dict[str, Any]:
    """Return the plain content of a file, of this format.

    Raises:
        OtherFormat: if it is of another version.
        ValueError: if it is too large, has too many lists and objects, is no object of JSON, or has
            a number that is none.
        RecursionError: if it is nested too deeply.
    """
    if len(data) > MAX_BYTES:
        raise ValueError(f"it has {len(data):,} bytes; at most {MAX_BYTES:,} are read")
    check_lists(data)
    content = json.loads(data, parse_constant=_refuse)
    if not isinstance(content, dict) or "format" not in content:
        raise ValueError("it does not say its format")
    check_format(name, content["format"], FORMAT)
    return content


def _refuse(constant: str) -> NoReturn:
    raise ValueError(f"{constant} is no number in JSON")


def _robots(content: Mapping[str, Any]) -> list[bytes]:
    """Return the documents of the stored robots of a file.

    Raises:
        HexapodError: if one is damaged, or of another robot than its name says.
        TypeError, ValueError, AttributeError: if they are no objects.
    """
    documents = []
    for robot_id, content_of_robot in dict(content.get("robots", {})).items():
        document = robot_documents.encode(content_of_robot)
        parse_document(document)
        if robot_documents.id_of(document) != robot_id:
            raise DamagedFile(f"the document of robot {robot_id} is that of another robot")
        documents.append(document)
    return documents


def _check_tables(tournament: TournamentFile) -> None:
    for digest, text in tournament.tables.items():
        if sha256_of(b64decode(text, validate=True)) != digest:
            raise DamagedFile(f"the table {digest} was changed: its SHA-256 is another one")
