"""`hexapods.toml` and the environment: options and settings by the same names, in their order."""

import inspect
import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from cyclopts import App

from app.cli.commands import command_paths
from app.cli.configuration import declared_settings, take_option
from app.cli.program import program_of
from app.setting_fields import variable_of
from hexapods.domain.errors import InvalidInput
from tests.cli.running import in_process, output, refusal

QUICK = '[train]\nsimulator = "kinematic"\nevaluate_every = 0\n'


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path


def write(folder: Path, text: str, name: str = "hexapods.toml") -> None:
    (folder / name).write_text(text, "utf-8")


def steps_of(folder: Path, *options: str, **variables: str) -> int:
    done = in_process("train", *options, folder=folder, **variables)
    assert done.returncode == 0, done.stderr
    return int(done.stdout.split()[1])


def test_the_command_line_comes_before_the_environment_and_that_before_the_file(
    folder: Path,
) -> None:
    write(folder, f"{QUICK}steps = 30\n")
    variables = {"HEXAPODS_TRAIN_STEPS": "20"}
    assert steps_of(folder) == 30
    assert steps_of(folder, HEXAPODS_TRAIN_STEPS="") == 30, "an empty variable counts as not set"
    assert steps_of(folder, **variables) == 20
    assert steps_of(folder, "--steps", "10", **variables) == 10
    write(folder, f"{QUICK}steps = 40\n", "other.toml")
    assert steps_of(folder, "--config", "other.toml") == 40
    assert steps_of(folder, HEXAPODS_CONFIG="other.toml") == 40
    assert steps_of(folder, "--config=hexapods.toml", HEXAPODS_CONFIG="other.toml") == 30


def test_the_file_has_every_form_of_an_option(folder: Path) -> None:
    write(
        folder,
        f"{QUICK}steps = 20\nagent = 'sarsa-lambda'\ntrace-decay = 0.5\njson = true\n"
        "robot = {preset = 'slippery'}\ndisturb = ['sensor-noise:sd_m=0.01:at=5']\n"
        "[race]\nsimulator = 'kinematic'\nlane = ['greedy', 'wave']\nsteps = 5\n",
    )
    config = output("train", folder=folder, run=in_process)["config"]
    assert config["settings"]["trace_decay"] == 0.5
    assert config["robot"] == {"preset": "slippery"}
    assert [happening["kind"] for happening in config["disturbances"]] == ["sensor-noise"]
    raced = output("race", folder=folder, run=in_process)
    assert [lane["agent"] for lane in raced["config"]["lanes"]] == ["greedy", "wave"]
    raced = output("race", "--lane", "random-walk", folder=folder, run=in_process)
    assert [lane["agent"] for lane in raced["config"]["lanes"]] == ["random-walk"]
    done = in_process("race", "--json", folder=folder, HEXAPODS_RACE_LANE="wave greedy wave")
    assert done.stdout.count('"training_id"') == 3


def test_settings_of_the_file_hold_for_every_command_and_the_environment_comes_first(
    folder: Path,
) -> None:
    write(folder, 'data = "kept"\nquota_mb = 5000\nwithout = ["tournaments", "demo"]\n')
    done = in_process("runs", "list", folder=folder, HEXAPODS_DATA="")
    assert done.returncode == 0, done.stderr
    rows = {
        row["name"]: (row["value"], row["source"])
        for row in output("config", folder=folder, run=in_process)["settings"]
    }
    assert rows["data"] == (str(folder / "data"), "HEXAPODS_DATA")
    assert rows["quota_mb"] == (5000, "hexapods.toml")
    assert rows["without"] == (["tournaments", "demo"], "hexapods.toml")
    assert rows["port"] == (8000, "default")
    assert not {"HEXAPODS_QUOTA_MB", "HEXAPODS_WITHOUT"} & os.environ.keys()


def test_config_shows_options_with_their_sources_and_no_secret(folder: Path) -> None:
    token = "a-token-for-the-tests"
    write(folder, f"{QUICK}[runs.list]\nlimit = 3\n[serve]\nshare = true\n")
    done = in_process("config", folder=folder, HEXAPODS_TRAIN_STEPS="20", HEXAPODS_TOKEN=token)
    assert done.returncode == 0, done.stderr
    rows = done.stdout.splitlines()
    assert "train --steps\t20\tHEXAPODS_TRAIN_STEPS" in rows
    assert "train --simulator\tkinematic\thexapods.toml" in rows
    assert "runs list --limit\t3\thexapods.toml" in rows
    assert "serve --share\tTrue\thexapods.toml" in rows
    assert "token\t(secret)\tHEXAPODS_TOKEN" in rows
    assert token not in done.stdout


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("x = ]", "hexapods.toml is not valid TOML"),
        ("prot = 1", "hexapods.toml: unknown setting 'prot'"),
        ("port = 99999", "port of hexapods.toml must be from 0 to 65535"),
        ("port = 'many'", "port of hexapods.toml must be a whole number"),
        ("port = 1979-05-27", "port of hexapods.toml must be a text, a number"),
        ("log_level = 'loud'", "log_level of hexapods.toml 'loud'; choose one of: debug"),
        ("train = 1", "train must be a table: [train]"),
        ("[trian]", "unknown command 'trian'"),
        ("[train]\nstep = 1", "step in [train] of hexapods.toml: unknown option"),
        ("[train]\ndata = 'x'", "write `data = …` above the tables"),
        ("[train]\nsteps = 'many'", "steps in [train] of hexapods.toml: must be a whole number"),
        ("[train]\nsteps = [1, 2]", "not '1,2'"),
        ("[train]\nobservation = 'felt'", '"measured", "commanded", "planned"'),
        ("[train]\ndepth = 2", "--depth (from hexapods.toml) is no setting of q-learning"),
        ("[runs]\nlimit = 2", "[runs] has a table for each verb"),
        ("[runs]\nlist = 2", "list must be a table: [runs.list]"),
        ("[serve]\nport = 2", "port is a setting"),
    ],
)
def test_a_refusal_names_file_key_and_what_is_valid(folder: Path, text: str, said: str) -> None:
    write(folder, text)
    command = {"[runs": ("runs", "list"), "[serv": ("serve",)}.get(text[:5], ("train",))
    sentence = refusal(*command, folder=folder, run=in_process)
    assert said in sentence
    assert "hexapods.toml" in sentence


def test_refusals_of_the_environment_and_of_the_option(folder: Path) -> None:
    for variables, said in (
        ({"HEXAPODS_TRAIN_STEP": "1"}, "HEXAPODS_TRAIN_STEP: unknown option of train 'step'"),
        ({"HEXAPODS_TRAIN_STEPS": "0"}, "HEXAPODS_TRAIN_STEPS: must be a whole number from 1"),
        ({"HEXAPODS_TRAIN_DATA": "x"}, "write HEXAPODS_DATA"),
        ({"HEXAPODS_CONFIG": "none.toml"}, "cannot read the configuration none.toml"),
    ):
        assert said in refusal("train", folder=folder, run=in_process, **variables)
    assert "needs a value" in refusal("train", "--config", folder=folder, run=in_process)
    with pytest.raises(InvalidInput, match="needs a value"):
        take_option(["train", "--config", "--", "x"])
    assert take_option(["verify", "--", "--config", "x"]) == (
        None,
        ["verify", "--", "--config", "x"],
    )


def options_of(app: App, chain: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], str]]:
    """Yield each option of a command and of its verbs, by its name of a variable."""
    for verb in app:
        if not verb.startswith("-"):
            yield from options_of(app[verb], (*chain, verb))
    for argument in app.assemble_argument_collection() if app.default_command else ():
        for name in argument.names:
            if name.startswith("--"):
                yield chain, name.removeprefix("--").replace("-", "_")


def test_no_option_has_the_variable_of_a_setting_and_one_of_its_name_is_the_setting() -> None:
    settings, program = declared_settings(), program_of()
    variables = {variable_of(name) for name in settings}
    same_names = set()
    for command in command_paths():
        for chain, name in options_of(program[command], (command,)):
            assert variable_of("_".join((*chain, name))) not in variables
            assert name != "config", "it is an option of all commands"
            if name in settings and command != "serve":
                same_names.add(name)
    assert same_names == {"data"}
    serve = inspect.signature(program["serve"].default_command)  # type: ignore[arg-type]
    assert serve.parameters.keys() - {"share"} <= settings.keys()
