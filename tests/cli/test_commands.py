"""Commands of features: found by name, left out with their feature, refused if they clash."""

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from app.cli import main
from app.cli.commands import CORE_COMMANDS, command_paths, verb_paths
from hexapods.domain.errors import InvalidInput

COMMAND = '''
def journal(*, loud: bool = False) -> int:
    """Say what the journal says."""
    print("DEAR JOURNAL," if loud else "Dear journal,")
    return 0


def add_to(verbs):
    verbs.command(journal)
'''


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    """Install a package with a command by its module `commands`, whose text is given."""

    def installed(commands: str) -> None:
        package = tmp_path / "hexapods_notes"
        about = tmp_path / "hexapods_notes-1.0.dist-info"
        for folder in (package, about):
            folder.mkdir()
        (package / "__init__.py").touch()
        (package / "commands.py").write_text(commands)
        (package / "journal_command.py").write_text(COMMAND)
        (about / "METADATA").write_text("Metadata-Version: 2.1\nName: hexapods-notes\nVersion: 1\n")
        (about / "entry_points.txt").write_text(
            "[hexapods.commands]\nnotes = hexapods_notes.commands\n"
        )
        monkeypatch.syspath_prepend(str(tmp_path))
        for module in [name for name in sys.modules if name.startswith("hexapods_notes")]:
            monkeypatch.delitem(sys.modules, module)

    return installed


def test_a_command_of_another_package_runs(
    install: Callable[[str], None], capsys: pytest.CaptureFixture[str]
) -> None:
    install('COMMANDS = {"journal": "hexapods_notes.journal_command:journal"}')
    assert main(["journal"]) == 0
    assert main(["journal", "--loud"]) == 0
    assert capsys.readouterr().out == "Dear journal,\nDEAR JOURNAL,\n"
    assert {**CORE_COMMANDS}.items() < command_paths().items()


def test_a_command_of_a_feature_that_is_left_out_says_so(
    install: Callable[[str], None],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    install('COMMANDS = {"journal": "hexapods_notes.journal_command:journal"}')
    monkeypatch.setenv("HEXAPODS_WITHOUT", "guide, notes")
    assert main(["journal"]) == 2
    assert "journal is a command of the feature notes" in capsys.readouterr().err
    assert "journal" not in command_paths()


def test_a_command_of_the_core_cannot_be_replaced(install: Callable[[str], None]) -> None:
    install('COMMANDS = {"train": "hexapods_notes.journal_command:journal"}')
    assert command_paths("train") == {"train": "app.cli.train:train"}
    with pytest.raises(InvalidInput, match="the feature notes has the command train"):
        command_paths()


def test_a_verb_of_another_package_runs_unless_its_feature_is_left_out(
    install: Callable[[str], None],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    install('COMMANDS = {}\nVERBS = {"runs": ["hexapods_notes.journal_command:add_to"]}')
    assert main(["runs", "journal"]) == 0
    assert capsys.readouterr().out == "Dear journal,\n"
    monkeypatch.setenv("HEXAPODS_WITHOUT", "notes")
    assert "hexapods_notes.journal_command:add_to" not in verb_paths("runs")
    assert main(["runs", "journal"]) == 2
    assert 'hexapods runs: Unknown command "journal"' in capsys.readouterr().err


VERIFIER = """
from app.cli.verifier import Verifier

VERIFIER = Verifier(
    thing="a diary",
    file="diary",
    origin="a diary in JSON",
    docs="the diary",
    recognizes=lambda content: "dear" in content,
    verify=lambda data, file, options: print(f"{file} has {len(data)} bytes") or 0,
)
"""


def test_verify_repeats_files_of_features(
    install: Callable[[str], None],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    install('COMMANDS = {}\nVERIFIERS = ["hexapods_notes.diary:VERIFIER"]')
    (tmp_path / "hexapods_notes" / "diary.py").write_text(VERIFIER)
    file = tmp_path / "diary.json"
    file.write_text('{"dear": "me"}')
    assert main(["verify", str(file)]) == 0
    assert capsys.readouterr().out == f"{file} has 14 bytes\n"
    assert main(["verify", "--help"]) == 0
    assert "a diary or a benchmark" in capsys.readouterr().out
    monkeypatch.setenv("HEXAPODS_WITHOUT", "notes, tournaments")
    assert main(["verify", str(file)]) == 2
    assert "diary.json is no score file that can be read" in capsys.readouterr().err


def test_commands_that_cannot_be_imported_are_named(
    install: Callable[[str], None], capsys: pytest.CaptureFixture[str]
) -> None:
    install("import nothing_of_this_name")
    assert command_paths("race") == {"race": "app.cli.race:race"}  # does not need the others
    assert main(["journal"]) == 2
    assert "`commands` of the feature notes cannot be imported" in capsys.readouterr().err


def test_commands_that_cannot_be_imported_can_be_left_out(
    install: Callable[[str], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    install("import nothing_of_this_name")
    monkeypatch.setenv("HEXAPODS_WITHOUT", "notes")
    assert command_paths().keys() >= CORE_COMMANDS.keys()
