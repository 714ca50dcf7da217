"""A tournament repeats to the last digit, and what was changed in its file is told."""

import json
from collections.abc import Iterator
from dataclasses import replace

import pytest

from hexapods.domain.errors import DamagedFile, InvalidInput
from hexapods.domain.model_robot import model_robot
from hexapods.domain.robot import PRESETS, document_of, read_document
from hexapods.domain.robot_library import LIBRARY, About
from hexapods.domain.settings import SettingValues
from hexapods.tournaments.entry import EntryConfig
from hexapods.tournaments.tournament_file import (
    JudgedEntry,
    TournamentFile,
    read_file,
    sha256_of,
    standings_of,
    write_file,
)
from hexapods.tournaments.verification import verify, version_note
from tests.model_robots import model_of
from tests.promises.length import only_whole
from tests.quick_robot import HASTY, QUICK_STEPS
from tests.tournaments.sample_tournaments import judged, rules_of, table_file

pytestmark = pytest.mark.test

OTHER_SECRET = "fedcba9876543210" * 4


@pytest.fixture(scope="module")
def kinematic() -> TournamentFile:
    rules = rules_of(tables=True)
    table = EntryConfig(agent="q-learning", table=sha256_of(table_file()))
    return judged(rules, [EntryConfig(agent="q-learning"), table], [table_file()])


def edited(tournament: TournamentFile, number: int, **changes: object) -> TournamentFile:
    entries = [
        replace(entry, **changes) if entry.number == number else entry  # type: ignore[arg-type]
        for entry in tournament.entries
    ]
    return replace(tournament, entries=tuple(entries))


def sentences(tournament: TournamentFile) -> list[str]:
    """Return what differs, of the file that others get."""
    return verify(read_file(write_file(tournament), "it"), workers=1)


@pytest.mark.test
def test_a_tournament_in_mujoco_repeats_with_any_number_of_processes() -> None:
    rules = rules_of(
        simulator="mujoco",
        gait="tripod",
        robot=HASTY,
        steps=10,
        tolerance=0.03,
        worlds=("flat", "ice"),
        robots=(PRESETS["dog"],),
    )
    tournament = judged(rules, [EntryConfig(agent="q-learning", robot=PRESETS["dog"])])
    counted: list[tuple[int, int]] = []
    read = read_file(write_file(tournament), "it")
    assert verify(read, 2, lambda *counts: counted.append(counts)) == []
    assert counted == [(done, 20) for done in range(1, 21)]
    assert version_note(read) is None


@pytest.fixture
def imported() -> Iterator[str]:
    """Store a robot from a file, and return its id."""
    stored = read_document(
        document_of(model_robot(model_of(PRESETS["stiff"]), "Own", **QUICK_STEPS)), "Own"
    )
    assert stored.id is not None
    LIBRARY.describe(stored.id, About("Own", "tripod"))
    yield stored.id
    LIBRARY.forget([stored.id])


@pytest.mark.test
def test_a_tournament_of_an_imported_robot_repeats_where_it_is_not_known(imported: str) -> None:
    stored = read_document(LIBRARY.find(imported), "Own")
    rules = rules_of(simulator="mujoco", gait="tripod", robot=HASTY, steps=10, robots=(stored,))
    assert rules.gaits == ("tripod",)
    data = write_file(judged(rules, [EntryConfig(agent="q-learning", robot=stored)]))
    LIBRARY.forget([imported])
    assert verify(read_file(data, "it"), workers=1) == []
    with pytest.raises(InvalidInput, match="no stored robot"):
        LIBRARY.find(imported)


def test_the_whole_repeats(kinematic: TournamentFile) -> None:
    assert sentences(kinematic) == []


def test_a_file_of_before_the_limit_of_transitions_was_a_rule_has_that_of_then() -> None:
    two_steps = EntryConfig(agent="look-ahead", settings=SettingValues({"depth": 2}))
    content = json.loads(write_file(judged(rules_of(), [two_steps])))
    del content["rules"]["transitions"]
    read = read_file(json.dumps(content).encode(), "it")
    assert read.rules.transitions == 40_000
    assert verify(read, workers=1) == []
    content["rules"]["transitions"] = 7_799
    differences = verify(read_file(json.dumps(content).encode(), "it"), workers=1)
    assert any(
        "m in the file, " in sentence and "over 7,799 transitions" in sentence
        for sentence in differences
    )
    content["rules"]["transitions"] = 100_001
    with pytest.raises(DamagedFile, match="transitions must be"):
        read_file(json.dumps(content).encode(), "it")


def test_a_file_of_before_an_agent_had_a_setting_repeats(kinematic: TournamentFile) -> None:
    content = json.loads(write_file(kinematic))
    del content["entries"][2]["entry"]["settings"]["order"], content["rules"]["reward"]

    assert verify(read_file(json.dumps(content).encode(), "it"), workers=1) == []


@only_whole
def test_a_file_of_before_the_limit_of_transitions_was_a_rule_repeats_with_that_of_then() -> None:
    deep = EntryConfig(agent="look-ahead", settings=SettingValues({"depth": 3}))
    content = json.loads(write_file(judged(rules_of(), [deep])))
    assert content["entries"][3]["judgements"][0]["failure"] is not None
    del content["rules"]["transitions"]
    assert verify(read_file(json.dumps(content).encode(), "it"), workers=1) == []
    content["rules"]["transitions"] = 100_000
    differences = verify(read_file(json.dumps(content).encode(), "it"), workers=1)
    assert any(
        "over 40,000 transitions" in sentence and "m repeated" in sentence
        for sentence in differences
    )


def test_one_changed_digit_of_a_distance_is_reported(kinematic: TournamentFile) -> None:
    entry = kinematic.entries[3]
    distance = entry.judgements[2].distance_m
    other = float(f"{distance:.16g}"[:-1] + ("1" if f"{distance:.16g}"[-1] != "1" else "2"))
    judgements = [
        replace(j, distance_m=other) if n == 2 else j for n, j in enumerate(entry.judgements)
    ]
    [difference] = sentences(edited(kinematic, 3, judgements=tuple(judgements)))
    assert difference.startswith("Entry 3 (entrant 3), draw 3 (seed ")
    assert difference.endswith(f", flat): {other!r} m in the file, {distance!r} m repeated.")


def test_an_improved_result_is_reported_with_its_standing(kinematic: TournamentFile) -> None:
    entry = kinematic.entries[3]
    best = tuple(replace(judgement, distance_m=0.9) for judgement in entry.judgements)
    changed = edited(kinematic, 3, judgements=best)
    standings = standings_of({each.number: each.judgements for each in changed.entries})
    differences = sentences(replace(changed, standings=tuple(standings)))
    assert [
        sentence for sentence in differences if sentence.startswith("Entry 3 (entrant 3), draw ")
    ] == differences[:3]
    assert differences[3] == "Entry 3 (entrant 3): 2 more of its 5 draws differ."
    assert any(
        sentence.startswith("Standing of Entry 3 (entrant 3): iqm_m is 0.9 in the file, ")
        for sentence in differences[4:]
    )


def test_another_secret_is_reported(kinematic: TournamentFile) -> None:
    differences = sentences(replace(kinematic, secret=OTHER_SECRET))
    assert differences[0].startswith(
        "The secret is not the one to which the tournament was committed"
    )
    assert any(sentence.startswith("Entry 3 (entrant 3), draw 1 ") for sentence in differences)


def test_a_removed_judgement_is_reported(kinematic: TournamentFile) -> None:
    fewer = kinematic.entries[3].judgements[:-1]
    assert sentences(edited(kinematic, 3, judgements=fewer)) == [
        "Entry 3 (entrant 3) has 4 judgements in the file; the rules have 5 draws."
    ]


def test_standings_in_another_order_are_reported(kinematic: TournamentFile) -> None:
    first, second, *rest = kinematic.standings
    [difference] = sentences(replace(kinematic, standings=(second, first, *rest)))
    assert difference.startswith(
        f"The standings are in the order {second.number}, {first.number}, "
    )


def test_exchanged_missing_and_additional_standings_are_reported(kinematic: TournamentFile) -> None:
    first, second, *rest = kinematic.standings
    swapped = (
        replace(second, number=first.number),
        replace(first, number=second.number),
        *rest,
    )
    differences = sentences(replace(kinematic, standings=swapped))
    assert any(
        sentence.startswith(f"Standing of Entry {second.number} ") for sentence in differences
    )
    missing, strange = replace(kinematic, standings=(first, *rest)), replace(first, number=99)
    assert sentences(missing) == [
        f"Entry {second.number} (entrant {second.number}) has no standing."
    ]
    assert sentences(replace(kinematic, standings=(*kinematic.standings, strange))) == [
        "There is a standing of entry 99, which is not there."
    ]


def test_a_missing_and_a_weakened_reference_are_reported(kinematic: TournamentFile) -> None:
    weak = replace(kinematic.entries[2].entry, steps=1)
    differences = sentences(edited(kinematic, 2, entry=weak))
    assert differences[0] == "Entry 2 is not the reference linear-model with its usual settings."
    differences = sentences(replace(kinematic, entries=kinematic.entries[1:]))
    assert differences[0] == "Entry 0, the reference greedy, is missing."


def test_an_entry_that_the_rules_do_not_allow_is_reported(kinematic: TournamentFile) -> None:
    differences = sentences(edited(kinematic, 3, entry=EntryConfig(agent="q-learning", steps=61)))
    assert differences == [
        "Entry 3 (entrant 3) cannot be judged: steps must be from 1 to 60, the budget of this "
        "tournament, not 61.",
        "The standings were not compared, as some entries could not be judged.",
    ]


def test_a_missing_and_an_exchanged_table_are_reported(kinematic: TournamentFile) -> None:
    digest = sha256_of(table_file())
    [difference, _] = sentences(replace(kinematic, tables={}))
    assert (
        difference
        == f"Entry 4 (entrant 4) cannot be judged: its table {digest} is not in the file."
    )
    other = judged(
        kinematic.rules,
        [EntryConfig(agent="q-learning", table=sha256_of(table_file(41)))],
        [table_file(41)],
    )
    exchanged = edited(replace(kinematic, tables=other.tables), 4, entry=other.entries[3].entry)
    difference = sentences(exchanged)[0]
    assert difference.startswith("Entry 4 (entrant 4), draw ")


def test_other_versions_are_a_note(kinematic: TournamentFile) -> None:
    versions = {**kinematic.versions, "numpy": "1.0", "mujoco": "2.0"}
    changed = read_file(write_file(replace(kinematic, versions=versions)), "it")
    note = version_note(changed)
    assert note is not None
    assert "instead of 1.0" in note
    assert "instead of 2.0" in note
    assert verify(changed, workers=1) == []


def test_the_number_of_workers_is_checked(kinematic: TournamentFile) -> None:
    with pytest.raises(InvalidInput, match="workers must be at least 1, not 0"):
        verify(kinematic, workers=0)


def test_a_file_without_entries_lacks_its_references(kinematic: TournamentFile) -> None:
    empty: tuple[JudgedEntry, ...] = ()
    differences = sentences(replace(kinematic, entries=empty, standings=()))
    assert differences == [
        f"Entry {number}, the reference {agent}, is missing."
        for number, agent in enumerate(("greedy", "random-walk", "linear-model"))
    ]
