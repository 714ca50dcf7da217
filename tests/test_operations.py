"""docs/operations.md, where it can be held to what it says."""

import re
import shutil
import sqlite3
from pathlib import Path

from app.cli.commands import command_paths
from app.setting_fields import PREFIX
from app.storage.database.migration import newest_revision
from app.storage.database.opening import ARTIFACTS_FOLDER, DATABASE_FILE
from app.storage.run import TABLE
from hexapods.benchmarking import score_file
from hexapods.domain import robot_documents
from hexapods.experiments import folder
from hexapods.experiments.config import SUMMARY_FORMAT
from hexapods.runs import tables
from hexapods.tournaments import tournament_file
from tests.setting_defaults import DEFAULTS
from tests.storage.stores import opened, training

TEXT = (Path(__file__).parent.parent / "docs" / "operations.md").read_text("utf-8")


def test_every_setting_is_there_with_its_default() -> None:
    rows = dict(re.findall(r"^\| `HEXAPODS_(\w+)` \| ([^|]+) \|", TEXT, flags=re.MULTILINE))
    assert {name.lower() for name in rows} == DEFAULTS.keys()
    for name, said in rows.items():
        default = DEFAULTS[name.lower()]
        default = int(default) if isinstance(default, bool) else default
        if isinstance(default, str | int):
            assert said == f"`{default}`", name
    assert set(re.findall(rf"{PREFIX}(\w+)", TEXT)) <= {*rows, "DATABASE_PASSWORD", "MEMORY_LIMIT"}


def test_the_document_has_the_version_of_each_format() -> None:
    rows = re.findall(r"^\| ([^|]+) \| (?:`|viser)[^|]* \| ([^|]*) ?\|$", TEXT, flags=re.MULTILINE)
    versions = {name: version.strip("` ") for name, version in rows}
    assert versions["database"].startswith(newest_revision())
    assert versions["table, checkpoint (`.npz`)"] == str(tables.FORMAT)
    assert versions["results of an experiment"] == str(folder.FORMAT) == str(SUMMARY_FORMAT)
    assert versions["document of a robot"] == robot_documents.FORMAT
    files = "score file of a benchmark, file of a tournament"
    assert versions[files] == str(score_file.FORMAT) == str(tournament_file.FORMAT)


def test_every_command_is_one() -> None:
    said = set(re.findall(r"hexapods (runs|export|import|serve|doctor|\w+ly)\b", TEXT))
    assert said == {"runs", "export", "import", "serve", "doctor"}
    assert said <= set(command_paths())


def test_every_promise_is_there() -> None:
    numbers = [int(number) for number in re.findall(r"^\| (\d+) \|", TEXT, flags=re.MULTILINE)]
    tests = (Path(__file__).parent / "promises").glob("test_??_*.py")
    assert numbers == sorted({int(test.name.split("_")[1]) for test in tests})


def test_a_backup_of_a_running_server_is_whole(tmp_path: Path) -> None:
    """As it says there; `.backup` is what SQLite's own command calls it."""
    data, copy = tmp_path / "data", tmp_path / "copy"
    with opened(data, None) as store:
        store.create(training("a"))
        for number in range(3):
            store.put_artifact("a", TABLE, bytes([number]) * 1000)
        copied = shutil.copytree(data / ARTIFACTS_FOLDER, copy / ARTIFACTS_FOLDER)
        store.put_artifact("a", TABLE, b"newest")
        with (
            sqlite3.connect(data / DATABASE_FILE) as source,
            sqlite3.connect(copy / DATABASE_FILE) as target,
        ):
            source.backup(target)
        source.close()
        target.close()
        shutil.copytree(data / ARTIFACTS_FOLDER, copied, dirs_exist_ok=True)
        store.create(training("b"))
    with opened(copy, None) as restored:
        assert [run.id for run in restored.list().items] == ["a"]
        assert restored.artifact("a", TABLE) == b"newest"
        assert len([file for file in copied.rglob("*") if file.is_file()]) == 1
