"""`hexapods verify` of a tournament's file, as a user runs it."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from hexapods.tournaments.entry import EntryConfig
from hexapods.tournaments.tournament_file import write_file
from tests.cli.running import hexapods, in_process, refusal
from tests.tournaments.sample_tournaments import judged, rules_of


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a tournament, `t.json`, and one that was changed, `changed.json`."""
    place = tmp_path_factory.mktemp("tournament")
    tournament = judged(rules_of(), [EntryConfig(agent="q-learning")])
    (place / "t.json").write_bytes(write_file(tournament))
    entry = tournament.entries[3]
    better = (
        tuple(replace(judgement, distance_m=0.9) for judgement in entry.judgements[:1])
        + entry.judgements[1:]
    )
    entries = (*tournament.entries[:3], replace(entry, judgements=better))
    (place / "changed.json").write_bytes(write_file(replace(tournament, entries=entries)))
    return place


def test_a_tournament_repeats(folder: Path) -> None:
    done = hexapods("verify", "t.json", "--workers", "2", folder=folder)
    assert done.returncode == 0, done.stderr
    assert "t.json repeats to the last digit: 4 entries on 5 draws." in done.stdout
    lines = [line.split() for line in done.stdout.splitlines()]
    assert lines[0] == ["A", "tournament"]
    assert [line[0] for line in lines[3:7]] == ["1–2", "1–2", "3", "4"]
    assert "entrant 3 (3)  Q-learning" in done.stdout


def test_a_changed_result_is_reported_with_exit_code_1(folder: Path) -> None:
    done = in_process("verify", "changed.json", folder=folder)
    assert done.returncode == 1
    assert "Entry 3 (entrant 3), draw 1 (seed " in done.stdout
    assert ": 0.9 m in the file, " in done.stdout
    assert "changed.json does not repeat" in done.stdout
    assert "repeats to the last digit" not in done.stdout


def test_it_prints_json(folder: Path) -> None:
    shown = json.loads(in_process("verify", "t.json", "--json", folder=folder).stdout)
    assert shown["repeats"] is True
    assert shown["differences"] == []
    assert shown["version_note"] is None
    assert [standing["best_rank"] for standing in shown["standings"]] == [1, 1, 3, 4]
    done = in_process("verify", "changed.json", "--json", folder=folder)
    assert done.returncode == 1
    assert len(json.loads(done.stdout)["differences"]) == 1


def test_bad_input_is_refused(folder: Path) -> None:
    (folder / "other.json").write_text("{}")
    assert "other.json is no tournament that can be read" in refusal(
        "verify", "other.json", folder=folder
    )
    assert "cannot read none.json" in refusal("verify", "none.json", folder=folder)
    sampled = refusal("verify", "t.json", "--sample", "2", folder=folder, run=in_process)
    assert "--sample is for score files of benchmarks" in sampled
    assert "workers must be at least 1" in refusal(
        "verify", "t.json", "--workers", "0", folder=folder
    )
