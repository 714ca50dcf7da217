"""Options from signatures: help in groups, errors that name what is valid, completion in bash."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.running import in_process, refusal

GAIT = ("--gait", "tripod")


def shown(*arguments: str, folder: Path) -> str:
    """Return what `--help` shows of a command in a terminal of 80 columns."""
    done = in_process(*arguments, "--help", folder=folder, COLUMNS="80")
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


def test_help_shows_the_settings_of_the_agents_that_are_named(tmp_path: Path) -> None:
    usual = shown("train", folder=tmp_path)
    assert len(usual.splitlines()) <= 80
    assert "Settings of q-learning" in usual
    assert "--alpha" in usual
    assert "default 0.3]" in usual
    assert "--depth" not in usual

    beam = shown("train", "--agent", "beam", folder=tmp_path)
    assert "Settings of beam" in beam
    assert "--width" in beam
    assert "--alpha" not in beam

    two = shown("sweep", "--agent=sarsa-lambda,linear-model", folder=tmp_path)
    assert two.index("Settings of sarsa-lambda") < two.index("Settings of linear-model")

    class_help = shown("benchmark", "tests.own_agents:Moody", folder=tmp_path)
    assert "Settings of tests.own_agents:Moody" in class_help
    assert "--mood" in class_help


def test_a_setting_of_another_agent_is_refused_with_those_of_this_one(tmp_path: Path) -> None:
    assert refusal(
        "train", *GAIT, "--agent", "beam", "--search-depth", "3", folder=tmp_path, run=in_process
    ).startswith("hexapods train: Unknown option: --search-depth.")
    assert refusal("train", *GAIT, "--depth", "3", folder=tmp_path, run=in_process) == (
        "hexapods train: --depth is no setting of q-learning, which has --alpha, --gamma, "
        "--objective, --average-rate, --epsilon-start, --epsilon-end; it is one of look-ahead, beam"
    )
    assert refusal(
        "train", *GAIT, "--agent", "greedy", "--alpha", "1", folder=tmp_path, run=in_process
    ).startswith("hexapods train: --alpha is no setting of greedy, which has none; ")


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("trian",), 'hexapods: Unknown command "trian". Did you mean "train"?'),
        (("runs", "lst"), 'hexapods runs: Unknown command "lst". Did you mean "list"?'),
        (("train", "--alpa", "1"), "hexapods train: Unknown option: --alpa. Did you mean --alpha?"),
        (("train", "--grid_side_m", "x"), "Invalid value for --grid_side_m: must be a number from"),
        (("train", "--grid-side-m"), "hexapods train: --grid-side-m needs a value: Side of"),
        (("train", "more"), "hexapods train: there is no argument 'more'"),
        (("race",), "hexapods race: --lane needs a value: agent of a lane, "),
        (("experiment",), "hexapods experiment: EXPERIMENT needs a value: table1, figure4, "),
        (("serve", "--port", "65536"), "serve: --port must be from 0 to 65535, not 65536"),
        (("serve", "--port", "web"), "--port: must be a whole number, not 'web'"),
        ((), "hexapods: name a command: serve, train, race, "),
        (("runs",), "hexapods runs: name a command: list, show, delete, "),
    ],
)
def test_what_cannot_be_understood_is_refused_with_what_is_meant(
    arguments: tuple[str, ...], sentence: str, tmp_path: Path
) -> None:
    assert sentence in refusal(*arguments, folder=tmp_path, run=in_process)


_IMPORTED = """
import sys
from app.cli.program import program_of
program_of(["train"])
imported = {"app.server", "app.cli.serve", "sqlalchemy", "starlette", "mujoco"} & {*sys.modules}
sys.exit(f"it imports {imported}" if imported else 0)
"""


def test_a_command_imports_nothing_of_the_others() -> None:
    done = subprocess.run(
        [sys.executable, "-c", _IMPORTED], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")


_COMPLETE = """
. {script}
hexapods() {{ {python} -m app.cli "$@"; }}
COMP_WORDS=(hexapods {words}) COMP_CWORD={place}
_hexapods
printf '%s\\n' "${{COMPREPLY[@]}}"
"""


def test_bash_completes_commands_options_and_values(tmp_path: Path) -> None:
    script = tmp_path / "hexapods.bash"
    done = in_process(
        "--install-completion", "--shell", "bash", "--output", str(script),
        folder=tmp_path, HOME=str(tmp_path),
    )  # fmt: skip
    assert done.returncode == 0, done.stderr

    def completed(words: str) -> list[str]:
        program = _COMPLETE.format(
            script=script, python=sys.executable, words=words, place=len(words.split())
        )
        run = subprocess.run(["bash", "-c", program], capture_output=True, text=True, check=False)
        assert (run.returncode, run.stderr) == (0, "")
        return run.stdout.split()

    assert completed("ru") == ["runs"]
    assert completed("runs sh") == ["show"]
    assert completed("train --al") == ["--alpha"]
    assert completed("train --simulator kin") == ["kinematic"]
    assert completed("train --objective av") == ["average"]
    assert completed("train --agent sarsa") == ["sarsa", "sarsa-lambda"]
