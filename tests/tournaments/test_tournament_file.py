"""Tournaments as files; what comes from elsewhere is refused unless it is one."""

import json
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from app.features.tournaments.tournaments import MAX_ROBOTS_BYTES, MAX_TABLES_BYTES
from hexapods.domain.errors import DamagedFile, InvalidInput, OtherFormat
from hexapods.domain.robot import PRESETS, document_of, read_document, robot
from hexapods.domain.robot_library import LIBRARY
from hexapods.tournaments.entry import EntryConfig
from hexapods.tournaments.rules import MAX_DRAWS, MAX_ENTRIES
from hexapods.tournaments.tournament_file import (
    MAX_BYTES,
    TournamentFile,
    read_file,
    sha256_of,
    tournament_file,
    write_file,
)
from tests.tournaments.sample_tournaments import SECRET, judged, rules_of, table_file


@pytest.fixture(scope="module")
def tournament() -> TournamentFile:
    rules = rules_of(robots=(PRESETS["dog"],), tables=True)
    entries = [
        EntryConfig(agent="q-learning", steps=30, robot=PRESETS["dog"]),
        EntryConfig(agent="q-learning", table=sha256_of(table_file())),
    ]
    return judged(rules, entries, [table_file()])


def test_a_file_is_the_tournament_to_the_last_bit(tournament: TournamentFile) -> None:
    data = write_file(tournament)
    assert read_file(data, "it") == tournament
    assert write_file(read_file(data, "it")) == data
    table = sha256_of(table_file())
    assert read_file(data, "it").table(table) == table_file()


def test_it_has_the_documents_of_stored_robots() -> None:
    data = document_of(robot({"preset": "crab", "femur_m": 0.072}))
    stored = read_document(data, "Pinch")
    assert stored.id is not None
    rules = rules_of(robot=stored, gait="tetrapod")
    tournament = tournament_file("Crabs", rules, SECRET, [])
    written = write_file(tournament)
    LIBRARY.forget([stored.id])
    with pytest.raises(InvalidInput, match="no stored robot"):
        LIBRARY.find(stored.id)
    again = read_file(written, "it")
    assert again.rules.robot == stored
    assert again.rules.robot.name == "Pinch"
    assert write_file(again) == written
    with pytest.raises(InvalidInput, match="no stored robot"):
        LIBRARY.find(stored.id)


def _changed(tournament: TournamentFile, change: Callable[[Any], object]) -> bytes:
    content = json.loads(write_file(tournament))
    change(content)
    return json.dumps(content).encode()


def _of(path: str, value: Any) -> Callable[[Any], object]:
    """Return a change of the value at a path, such as `entries.0.name`."""

    def change(content: Any) -> None:
        *parents, last = path.split(".")
        for parent in parents:
            content = content[int(parent)] if isinstance(content, list) else content[parent]
        content[last] = value

    return change


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda content: content.pop("format"), "does not say its format"),
        (lambda content: content.pop("secret"), "secret"),
        (_of("winner", 3), "winner"),
        (_of("entries.0.code", "print()"), "entries.0.code"),
        (_of("entries.0.entry.code", "print()"), "code"),
        (_of("entries", {}), "entries"),
        (_of("entries.0.number", "0"), "number"),
        (_of("entries.0.number", 1), "numbered ascending"),
        (_of("entries.0.name", "a\u001b[31m"), r"a name must be .* U\+001B"),
        (_of("title", "x" * 101), "a name must be"),
        (_of("entries.0.judgements.0.distance_m", "0.1"), "distance_m"),
        (_of("entries.0.judgements.0.distance_m", float("nan")), "NaN is no number in JSON"),
        (_of("entries.0.judgements.0.failure", "it fell"), "must be 0"),
        (_of("entries.0.entry.settings", {"alpha": [1]}), "alpha must be a number"),
        (_of("rules.draws", 3), "draws must be"),
        (_of("rules.worlds", ["moon"]), "unknown world 'moon'"),
        (_of("rules.worlds", [7]), "worlds"),
        (_of("rules.robot", {"id": "0" * 16}), "no stored robot"),
        (_of("robots", {"0" * 16: {}}), "it must have its legs and numbers"),
        (_of("robots", {"0" * 16: 7}), "mapping"),
        (_of("robots", [7]), ""),
        (_of("tables", {"00": "AA=="}), "table 00 was changed"),
        (_of("tables", {"00": "%"}), ""),
    ],
)
def test_what_is_no_tournament_is_refused(
    tournament: TournamentFile, change: Callable[[Any], object], message: str
) -> None:
    with pytest.raises(DamagedFile, match=rf"^it is no tournament that can be read: .*{message}"):
        read_file(_changed(tournament, change), "it")


@pytest.mark.parametrize("version", [0, 2])
def test_another_format_is_refused(tournament: TournamentFile, version: int) -> None:
    with pytest.raises(OtherFormat, match=f"it has format {version}; this version reads 1 alone"):
        read_file(_changed(tournament, _of("format", version)), "it")


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"{",
        b"[]",
        b"\xff\xfe",
        b'{"format": 1, "title": ' + b"[" * 100_000,
        b'{"format": 1, "commitment": 1e999}',
        b'{"format": ' + b"9" * 10_000 + b"}",
    ],
)
def test_other_files_are_refused(data: bytes) -> None:
    with pytest.raises(DamagedFile, match=r"^q\.json is no tournament that can be read"):
        read_file(data, "q.json")


def test_infinite_distances_are_refused(tournament: TournamentFile) -> None:
    distance = repr(tournament.entries[0].judgements[0].distance_m).encode()
    with pytest.raises(DamagedFile, match="finite"):
        read_file(write_file(tournament).replace(distance, b"1e999"), "it")


def test_a_changed_table_is_refused(tournament: TournamentFile) -> None:
    digest = sha256_of(table_file())
    text = tournament.tables[digest]
    middle = len(text) // 2
    other = "A" if text[middle] != "A" else "B"
    changed = replace(tournament, tables={digest: text[:middle] + other + text[middle + 1 :]})
    with pytest.raises(DamagedFile, match=f"the table {digest} was changed"):
        read_file(write_file(changed), "it")


def test_the_number_of_entries_is_limited(tournament: TournamentFile) -> None:
    first = tournament.entries[0]
    many = tuple(replace(first, number=number) for number in range(MAX_ENTRIES + 1))
    with pytest.raises(InvalidInput, match="at most 300 entries, not 301"):
        replace(tournament, entries=many)


@pytest.mark.parametrize("member", [b"[],", b"{},"])
def test_a_file_of_very_many_lists_is_refused_before_it_is_read(member: bytes) -> None:
    data = b'{"format":1,"machine":{"x":[' + member * 200_000 + b"0]}}"

    with pytest.raises(DamagedFile, match="more than 100,000 lists and objects"):
        read_file(data, "it")


def test_a_file_is_no_larger_than_all_that_a_tournament_may_hold() -> None:
    most = MAX_TABLES_BYTES + 2 * MAX_ROBOTS_BYTES + MAX_ENTRIES * MAX_DRAWS * 100

    assert most < MAX_BYTES < 1.25 * most
