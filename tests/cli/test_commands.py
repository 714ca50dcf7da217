"""Commands of features: found by name, left out with their feature, refused if they clash."""

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from app.cli import main
from app.cli.commands import CORE_COMMANDS, command_modules, verb_modules
from hexapods.domain.errors import InvalidInput

COMMAND = '''"""Say what the journal says."""


def add_to(commands):
    parser = commands.add_parser("journal", help="read the journal")
    parser.set_defaults(run=lambda options: print("Dear journal,") or 0)
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
    install('COMMANDS = {"journal": "hexapods_notes.journal_command"}')
    assert main(["journal"]) == 0
    assert capsys.readouterr().out == "Dear journal,\n"
    assert {**CORE_COMMANDS}.items() < command_modules().items()


def test_a_command_of_a_feature_that_is_left_out_says_so(
    install: Callable[[str], None],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    install('COMMANDS = {"journal": "hexapods_notes.journal_command"}')
    monkeypatch.setenv("HEXAPODS_WITHOUT", "guide, notes")
    assert main(["journal"]) == 2
    assert "journal is a command of the feature notes" in capsys.readouterr().err
    assert "journal" not in command_modules()


def test_a_command_of_the_core_cannot_be_replaced(install: Callable[[str], None]) -> None:
    install('COMMANDS = {"train": "hexapods_notes.journal_command"}')
    assert command_modules("train") == {"train": "app.cli.train"}
    with pytest.raises(InvalidInput, match="the feature notes has the command train"):
        command_modules()


def test_a_verb_of_another_package_runs_unless_its_feature_is_left_out(
    install: Callable[[str], None],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    install('COMMANDS = {}\nVERBS = {"runs": ["hexapods_notes.journal_command"]}')
    assert main(["runs", "journal"]) == 0
    assert capsys.readouterr().out == "Dear journal,\n"
    monkeypatch.setenv("HEXAPODS_WITHOUT", "notes")
    assert "hexapods_notes.journal_command" not in verb_modules("runs")
    with pytest.raises(SystemExit):
        main(["runs", "journal"])
    assert "invalid choice: 'journal'" in capsys.readouterr().err


VERIFIER = """
from app.cli.verifier import Verifier

VERIFIER = Verifier(
    thing="a diary",
    file="diary",
    origin="a diary in JSON",
    docs="the diary",
    recognizes=lambda content: "dear" in content,
    verify=lambda data, options: print(f"{options.file} has {len(data)} bytes") or 0,
)
"""


def test_verify_repeats_files_of_features(
    install: Callable[[str], None],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    install('COMMANDS = {}\nVERIFIERS = ["hexapods_notes.diary"]')
    (tmp_path / "hexapods_notes" / "diary.py").write_text(VERIFIER)
    file = tmp_path / "diary.json"
    file.write_text('{"dear": "me"}')
    assert main(["verify", str(file)]) == 0
    assert capsys.readouterr().out == f"{file} has 14 bytes\n"
    with pytest.raises(SystemExit):
        main(["verify", "--help"])
    assert "a diary or a benchmark" in capsys.readouterr().out
    monkeypatch.setenv("HEXAPODS_WITHOUT", "notes, tournaments")
    assert main(["verify", str(file)]) == 2
    assert "diary.json is no score file that can be read" in capsys.readouterr().err


def test_commands_that_cannot_be_imported_are_named(
    install: Callable[[str], None], capsys: pytest.CaptureFixture[str]
) -> None:
    install("import nothing_of_this_name")
    assert command_modules("race") == {"race": "app.cli.race"}  # does not need the others
    assert main(["journal"]) == 2
    assert "`commands` of the feature notes cannot be imported" in capsys.readouterr().err


def test_commands_that_cannot_be_imported_can_be_left_out(
    install: Callable[[str], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    install("import nothing_of_this_name")
    monkeypatch.setenv("HEXAPODS_WITHOUT", "notes")
    assert command_modules().keys() >= CORE_COMMANDS.keys()
