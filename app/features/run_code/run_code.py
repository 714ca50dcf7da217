"""A run as code: the commands, and the Python program, that make exactly this run.

Both are calls of the library's functions with what differs from the defaults. Trainings on which a
run rests are practised first; a table that no practice repeats, of a training that was stopped,
imported or deleted, is a file.
"""

import json
import shlex
from collections.abc import Iterable, Mapping
from dataclasses import fields, replace
from pprint import pformat
from typing import Any, NamedTuple

from app.answer import Answer
from app.storage.database.store import RunStore
from app.storage.errors import Damaged, NotFound
from app.storage.run import Run, robots_of, world_of
from hexapods.agents.registry import keeps_learning
from hexapods.domain.disturbance_documents import as_text
from hexapods.domain.errors import HexapodError
from hexapods.domain.records import to_json
from hexapods.domain.robot import PRESETS, Robot, as_mapping
from hexapods.domain.settings import Value, declared_fields
from hexapods.experiments.config import ExperimentConfig, by_option, experiment_config
from hexapods.runs.config import TrainingConfig, WalkingProblem, agent_settings
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import RaceConfig

MAX_CONTINUED = 100
"""Trainings that continue each other and are practised again; of an earlier one the table is
downloaded."""
_ALWAYS = ("gait", "steps", "seed", "seeds")
"""Arguments that are spelt out whatever their value."""
_DEFAULTS = to_json(TrainingConfig())
_INHERITED = ("robot", "simulator", "divisions", "grid_side_m", "reward", "observation")
"""Arguments whose default in Python is that of the training that goes on, or races."""

Arguments = dict[str, Any]
"""Plain values by argument of the library's functions."""


_IMPORT = "import hexapods as hx"


class CodeView(Answer):
    """A run as commands for a shell, and as a Python program."""

    command: str
    python: str


class _Code(NamedTuple):
    """A Python expression, whose `repr` is without quotes."""

    text: str

    def __repr__(self) -> str:
        return self.text


def run_code(run: Run, store: RunStore, address: str) -> CodeView:
    """Return the code of a run.

    Args:
        run: the run, in any state; of one that was stopped, the whole run.
        store: store of the trainings that it rests on.
        address: address of this server, with a slash at its end.
    """
    robots = _Robots(address)
    robots.add(robots_of(run.config))
    if isinstance(run.config, ExperimentConfig):
        return robots.before(_experiment(run.config))
    practices = _Practices(store, address)
    if isinstance(run.config, TrainingConfig):
        practices.add(run)
    else:
        for training_id in filter(None, run.lane_training_ids):
            practices.add_id(training_id)
        practices.add_race(run, run.config)
    for config in filter(None, practices.configs):
        robots.add([config.robot])
    python = "\n\n".join([_IMPORT, *practices.calls]) + "\n"
    return robots.before(CodeView(command=_lines(practices.commands), python=python))


class _Robots:
    """Stored robots that a run needs, which are downloaded and imported first.

    They are not written out: those from files have meshes.
    """

    def __init__(self, address: str) -> None:
        self._address = address
        self._names: dict[str, str] = {}

    def add(self, robots: Iterable[Robot]) -> None:
        """Add robots; those that are not stored are left out."""
        for robot in robots:
            if robot.id is not None:
                self._names[robot.id] = as_mapping(robot)["name"]

    def before(self, code: CodeView) -> CodeView:
        """Return the code, preceded by the download and import of the robots."""
        commands, calls = "", ""
        for robot_id, name in self._names.items():
            file, url = f"robot-{robot_id}.json", f"{self._address}api/v1/robots/{robot_id}/file"
            commands += (
                f"curl --fail --output {file} {shlex.quote(url)}\n"
                f"hexapods robots import {file} --name {shlex.quote(name)}\n"
            )
            calls += f"\n\n# {url}\nhx.load_robot({file!r}, {name!r})"
        python = code.python.replace(_IMPORT, _IMPORT + calls, 1)
        return CodeView(command=commands + code.command, python=python)


class _Practices:
    """The trainings of a run, in the order in which they are practised.

    Attributes:
        commands, calls: commands of the command line, and calls in Python.
    """

    def __init__(self, store: RunStore, address: str) -> None:
        self._store, self._address = store, address
        self._configs: dict[str, TrainingConfig | None] = {}
        """Configs by id; None for a table that is a file."""
        self.commands: list[str] = []
        self.calls: list[str] = []

    @property
    def configs(self) -> Iterable[TrainingConfig | None]:
        """Configs of the trainings so far; None for a table that is a file."""
        return self._configs.values()

    def add_id(self, training_id: str) -> None:
        """Add a training whose table is needed; as a file, if it cannot be practised again."""
        run = self._practised(training_id)
        if run is None:
            self._add_file(training_id)
        else:
            self.add(run)

    def _practised(self, training_id: str) -> Run | None:
        """Return a training that can be practised again; None if it cannot."""
        try:
            run = self._store.get(training_id)
        except (NotFound, Damaged):
            return None
        # An imported table was never practised here.
        is_whole = run.state == "finished" and run.started_at is not None
        return run if is_whole and isinstance(run.config, TrainingConfig) else None

    def add(self, run: Run) -> None:
        """Add a training, after those that it continues."""
        runs = {run.id: run}
        while (before := run.continued_from) is not None and before not in self._configs:
            earlier = self._practised(before)
            # An imported run may say that it continues itself.
            if earlier is None or before in runs or len(runs) >= MAX_CONTINUED:
                self._add_file(before)
                break
            runs[before] = run = earlier
        for training in reversed(runs.values()):
            self._add(training)

    def _add(self, run: Run) -> None:
        if run.id in self._configs or not isinstance(run.config, TrainingConfig):
            return
        before = run.continued_from
        arguments = self._differing(run.config, [] if before is None else [before])
        arguments |= _differing_settings(run.config.agent, run.config.settings)
        tuned = {name for change in run.changes for name in change.get("settings", ())}
        if any("presses" in change for change in run.changes):
            self.commands.append(
                "# People taught it by presses of + and −, which no command repeats; the Python "
                f"program does.\n{self._download(run.id)}"
            )
        elif tuned:
            names = ", ".join(sorted(tuned))
            self.commands.append(
                f"# While it ran, {names} changed, which no command repeats; the Python program "
                f"does.\n{self._download(run.id)}"
            )
        else:
            # Disturbances of the run happen at the same step.
            world = _world(replace(run.config, world=world_of(run)))
            self.commands.append(_training_command(run, {**arguments, **world}))
        if before is not None:
            arguments["table"] = _Code(_variable(before))
        if changes := [c for c in map(_without_pace, run.changes) if set(c) != {"step"}]:
            arguments["changes"] = changes
        variable = self._keep(run.id, run.config)
        call = _call("train", repr(run.config.agent), arguments)
        self.calls.append(f"{variable} = {call}\nprint({variable}.result)")

    def _add_file(self, training_id: str) -> None:
        if training_id not in self._configs:
            self.commands.append(self._download(training_id))
            variable, file = self._keep(training_id, None), _file(training_id)
            self.calls.append(f"# {self._table(training_id)}\n{variable} = hx.load({file!r})")

    def add_race(self, run: Run, config: RaceConfig) -> None:
        """Add the race, after the trainings of its lanes."""
        ids = [training_id for training_id in run.lane_training_ids if training_id is not None]
        arguments = self._differing(config, ids)
        lanes = list(zip(config.lanes, run.lane_training_ids, strict=True))
        self.commands.append(_race_command(lanes, arguments))
        calls = "".join(f"\n        {_lane_call(lane, practised)}," for lane, practised in lanes)
        self.calls.append(
            f"race = {_call('race', f'[{calls}{chr(10)}    ]', arguments)}\nprint(race.result)"
        )

    def _differing(self, config: WalkingProblem, rests_on: Iterable[str]) -> Arguments:
        """Return the arguments, but settings, that differ from the defaults.

        Args:
            config: config of the run.
            rests_on: ids of the trainings from which Python takes arguments that are left out.
        """
        practices = [self._configs[training_id] for training_id in rests_on]
        arguments: Arguments = {}
        values = {
            k: v for k, v in to_json(config).items() if k in _DEFAULTS and k in _named(config)
        }
        for name, value in values.items():
            is_inherited = name in _INHERITED and any(
                practice is None or to_json(practice)[name] != value for practice in practices
            )
            if name in _ALWAYS or value != _DEFAULTS[name] or is_inherited:
                arguments[name] = value
        if "robot" in arguments and config.robot.id is None and config.robot in PRESETS.values():
            arguments["robot"] = config.robot.name
        return arguments | _world(config)

    def _keep(self, training_id: str, config: TrainingConfig | None) -> str:
        self._configs[training_id] = config
        return _variable(training_id)

    def _table(self, training_id: str) -> str:
        return f"{self._address}api/v1/trainings/{training_id}/q-table?format=npz"

    def _download(self, training_id: str) -> str:
        return f"curl --fail --output {_file(training_id)} {shlex.quote(self._table(training_id))}"


def _named(config: WalkingProblem) -> set[str]:
    """Return the names of a config's fields that are arguments by themselves."""
    return {field.name for field in fields(config)} - {
        "world",
        "agent",
        "settings",
        "pace",
        "lanes",
    }


def _world(config: WalkingProblem) -> Arguments:
    """Return the disturbances, each as both the command line and Python read them."""
    texts = [as_text(disturbance) for disturbance in config.world.disturbances]
    return {"world": texts} if texts else {}


def _without_pace(change: Mapping[str, Any]) -> Arguments:
    return {name: value for name, value in change.items() if name != "pace"}


def _differing_settings(agent: str, settings: Mapping[str, Value]) -> dict[str, Value]:
    """Return the settings that are not the agent's defaults; all of an agent that is unknown."""
    try:
        defaults = {name: setting.default for name, setting in agent_settings(agent).items()}
    except HexapodError:
        defaults = {}
    return {
        name: value
        for name, value in settings.items()
        if value is not None and (name not in defaults or value != defaults[name])
    }


def _lane_arguments(lane: LaneConfig, is_practised: bool) -> Arguments:
    usual: Arguments = {"keep_learning": _keeps_learning(lane.agent)}
    arguments = {
        name: getattr(lane, name)
        for name, setting in declared_fields(LaneConfig).items()
        if getattr(lane, name) != usual.get(name, setting.default)
        and not (is_practised and name == "observation")
    }
    return {**arguments, **_differing_settings(lane.agent, lane.settings)}


def _keeps_learning(agent: str) -> bool:
    try:
        return keeps_learning(agent)
    except HexapodError:
        return False


# ---- Python


def _call(function: str, first: str, arguments: Arguments) -> str:
    texts = {name: _indented(pformat(value, sort_dicts=False)) for name, value in arguments.items()}
    lines = "".join(f"    {name}={text},\n" for name, text in texts.items())
    return f"hx.{function}(\n    {first},\n{lines})"


def _indented(text: str) -> str:
    return text.replace("\n", "\n    ")


def _lane_call(lane: LaneConfig, training_id: str | None) -> str:
    agent = repr(lane.agent) if training_id is None else _variable(training_id)
    arguments = _lane_arguments(lane, training_id is not None)
    return f"hx.lane({', '.join([agent, *(f'{k}={v!r}' for k, v in arguments.items())])})"


def _file(training_id: str) -> str:
    return f"q-{training_id}.npz"


def _variable(training_id: str) -> str:
    return f"table_{training_id}"


# ---- commands


def _training_command(run: Run, arguments: Arguments) -> str:
    options = list(_options(arguments))
    if run.continued_from is not None:
        options = [(flag, text) for flag, text in options if flag != "--seed"]
        options.append(("--from", _file(run.continued_from)))
    agent = getattr(run.config, "agent", None)
    if agent != TrainingConfig.agent:
        options.append(("--agent", str(agent)))
    return _command("hexapods train", [*options, ("--out", _file(run.id))])


def _race_command(lanes: Iterable[tuple[LaneConfig, str | None]], arguments: Arguments) -> str:
    options = list(_options(arguments))
    for lane, training_id in lanes:
        head = lane.agent if training_id is None else f"{lane.agent}={_file(training_id)}"
        settings = _lane_arguments(lane, training_id is not None)
        options.append(
            ("--lane", ",".join([head, *(f"{k}={_text(v)}" for k, v in settings.items())]))
        )
    return _command("hexapods race", options)


def _options(arguments: Arguments) -> Iterable[tuple[str, str]]:
    for name, value in arguments.items():
        if name == "world":
            yield from (("--disturb", text) for text in value)
        else:
            yield f"--{name.replace('_', '-')}", _text(value)


def _command(program: str, options: Iterable[tuple[str, str]]) -> str:
    return " \\\n    ".join([program, *(f"{flag} {shlex.quote(text)}" for flag, text in options)])


def _text(value: Any) -> str:
    if isinstance(value, Mapping):
        return json.dumps(value)
    return str(value).lower() if isinstance(value, bool) else str(value)


def _lines(commands: Iterable[str]) -> str:
    return "\n".join(commands) + "\n"


# ---- experiments

_REPEATED = {"gaits": "--gait", "robots": "--robot", "agents": "--agent", "worlds": "--world"}


def _experiment(config: ExperimentConfig) -> CodeView:
    name, differences = config.experiment, _experiment_differences(config)
    options: list[tuple[str, str]] = []
    for key, value in differences.items():
        if key in _REPEATED:
            options += [(_REPEATED[key], _part(element)) for element in value]
        elif key == "observations":
            options.append(("--observation", ",".join(value)))
        else:
            values = value if isinstance(value, list) else [value]
            options.append((f"--{key.replace('_', '-')}", ",".join(map(_text, values))))
    program = f"hexapods {config.preset.command}"
    call = _call("experiment", repr(name), {"folder": f"{name}-results", **differences})
    python = (
        f"{_IMPORT}\n\n"
        'if __name__ == "__main__":  # its trials have processes of their own\n'
        f"    experiment = {_indented(call)}\n"
        '    print(*experiment.settings, sep="\\n")\n'
    )
    return CodeView(command=_lines([_command(program, options)]), python=python)


def _part(value: Any) -> str:
    is_preset = isinstance(value, dict) and set(value) == {"preset"}
    return str(value["preset"]) if is_preset else _text(value)


def _experiment_differences(config: ExperimentConfig) -> Arguments:
    """Return the arguments that differ from the defaults with this simulator and these agents."""
    name, shown = config.experiment, by_option(to_json(config))
    chosen: Arguments = {"simulator": config.simulator}
    if "agents" in config.preset.fields:
        chosen["agents"] = config.agents
    usual = to_json(experiment_config(name, {}))
    expected = {
        **by_option(to_json(experiment_config(name, chosen))),
        **{key: usual[key] for key in chosen},
        "experiment": name,
    }
    return {k: v for k, v in shown.items() if k in _ALWAYS or v != expected.get(k)}
