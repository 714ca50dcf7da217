"""A run as code: the commands, and the Python program, that make exactly this run.

Both spell out what differs from the defaults. Trainings on which a run rests are practised first; a
table that no practice repeats, of a training that was stopped, imported or deleted, is a file.
"""

import json
import shlex
from collections.abc import Iterable, Mapping
from dataclasses import fields, replace
from pprint import pformat
from typing import Any, NamedTuple

from app.agents.registry import keeps_learning
from app.domain.disturbances import as_text
from app.domain.errors import HexapodError
from app.domain.robot import PRESETS
from app.domain.robot import as_mapping as robot_as_mapping
from app.domain.settings import Value
from app.experiments.config import ExperimentConfig, experiment_config, fields_of
from app.experiments.config import as_json as experiment_as_json
from app.runs.config import TrainingConfig, WalkingProblem, agent_settings
from app.runs.config_json import as_json
from app.runs.lane import LaneConfig
from app.runs.race_config import RaceConfig
from app.storage.database.store import RunStore
from app.storage.errors import Damaged, NotFound
from app.storage.run import Run, world_of

MAX_CONTINUED = 100
"""Trainings that continue each other and are practised again; of an earlier one the table is
downloaded."""
_WALK = {one.name: one.default for one in fields(WalkingProblem)}
_NOT_IN_COMMANDS = ("pace", "agent", "settings", "seed", *_WALK)


class RunCode(NamedTuple):
    """A run as code."""

    command: str
    python: str


def run_code(run: Run, store: RunStore, address: str) -> RunCode:
    """Return the code of a run.

    Args:
        run: the run, in any state; of one that was stopped, the whole run.
        store: store of the trainings that it rests on.
        address: of this server, with a slash at its end.
    """
    if isinstance(run.config, ExperimentConfig):
        return RunCode(_experiment_command(run.config), _experiment_python(run.config))
    practices = _Practices(store, address)
    if isinstance(run.config, TrainingConfig):
        practices.add(run)
        return RunCode(practices.command(), practices.python())
    for training_id in filter(None, run.lane_training_ids):
        practices.add_id(training_id)
    return RunCode(
        _lines([*practices.commands, _race_command(run, run.config)]),
        practices.python(run, run.config),
    )


class _Practices:
    """The trainings of a run, in the order in which they are practised."""

    def __init__(self, store: RunStore, address: str) -> None:
        self._store, self._address = store, address
        self._ids: list[str] = []
        self.commands: list[str] = []
        self._code: list[str] = []
        self._has_changes = False

    def add_id(self, training_id: str) -> None:
        """Add a training whose table is needed; what cannot be practised again, as a file."""
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
        while (before := run.continued_from) is not None and before not in self._ids:
            earlier = self._practised(before)
            # An imported run may say that it continues itself.
            if earlier is None or before in runs or len(runs) >= MAX_CONTINUED:
                self._add_file(before)
                break
            runs[before] = run = earlier
        for one in reversed(runs.values()):
            self._add(one)

    def _add(self, run: Run) -> None:
        if run.id in self._ids or not isinstance(run.config, TrainingConfig):
            return
        self._ids.append(run.id)
        rates = [c for c in run.changes if set(c) - {"step", "pace", "disturbance"}]
        if rates:
            names = ", ".join(sorted({name for c in rates for name in c if name != "step"}))
            self.commands.append(
                f"# While it ran, {names} changed, which no command repeats; the Python program "
                f"does.\n{self._download(run.id)}"
            )
        else:
            # Disturbances of the run happen at the same step.
            config = replace(run.config, world=world_of(run))
            self.commands.append(_training_command(run, config))
        self._code.append(self._training_python(run, run.config))

    def _add_file(self, training_id: str) -> None:
        if training_id in self._ids:
            return
        self._ids.append(training_id)
        self.commands.append(self._download(training_id))
        name = _file(training_id)
        self._code.append(
            f"# As {self._table_address(training_id)}\n"
            f'{_variable(training_id)} = from_bytes(Path("{name}").read_bytes(), "{name}")'
        )

    def _table_address(self, training_id: str) -> str:
        return f"{self._address}api/v1/trainings/{training_id}/q-table?format=npz"

    def _download(self, training_id: str) -> str:
        address = shlex.quote(self._table_address(training_id))
        return f"curl --fail --output {_file(training_id)} {address}"

    def _training_python(self, run: Run, config: TrainingConfig) -> str:
        arguments = {**_training_arguments(config), **_own_settings(config.agent, config.settings)}
        if config.agent != TrainingConfig.agent:
            arguments = {"agent": repr(config.agent), **arguments}
        given = ["config"]
        if run.continued_from is not None:
            given.append(f"table={_variable(run.continued_from)}")
        changes = [{k: v for k, v in c.items() if k != "pace"} for c in run.changes]
        changes = [change for change in changes if set(change) != {"step"}]
        if changes:
            self._has_changes = True
            given.append(f"changes={pformat(changes, sort_dicts=False)}")
        return "\n".join(
            [
                _call("config", "training_config", arguments),
                f"learner = practise({', '.join(given)})",
                "print(finish_training(learner, config))",
                f"{_variable(run.id)} = snapshot(learner, config)",
            ]
        )

    def command(self) -> str:
        """Return the commands."""
        return _lines(self.commands)

    def python(self, race: Run | None = None, config: RaceConfig | None = None) -> str:
        """Return the program, with a race at its end if one is given."""
        body = list(self._code)
        if race is not None and config is not None:
            body.append(_race_python(race, config))
        text = "\n\n".join(body)
        practise = [_practise(self._has_changes)] if "practise(" in text else []
        return "\n\n".join([_imports("\n".join([*practise, text])), *practise, text]) + "\n"


def _practise(has_changes: bool) -> str:
    if not has_changes:
        return (
            "\ndef practise(config, table=None):\n"
            "    learner = build_learner(config, table)\n"
            "    for _ in train(learner, config):\n"
            "        pass\n"
            "    return learner\n"
        )
    return (
        "\ndef practise(config, table=None, changes=()):\n"
        "    learner, to_come = build_learner(config, table), list(changes)\n"
        "    for _ in chain([None], train(learner, config)):\n"
        '        while to_come and to_come[0]["step"] <= learner.step:\n'
        "            change = dict(to_come.pop(0))\n"
        '            del change["step"]\n'
        '            if "disturbance" in change:\n'
        '                learner.disturb(disturbance(change.pop("disturbance")), config)\n'
        "            if change:\n"
        "                learner.walker.agent.tune(**change)\n"
        "    return learner\n"
    )


_MODULES = {
    "itertools": ("chain",),
    "pathlib": ("Path",),
    "time": ("perf_counter",),
    "app.assembly": ("build_learner", "build_walkers", "finish_training"),
    "app.domain.disturbances": ("disturbance",),
    "app.domain.gait": ("GaitSpec",),
    "app.domain.robot": ("robot",),
    "app.domain.world": ("world",),
    "app.runs.config": ("training_config",),
    "app.runs.lane": ("lane_config",),
    "app.runs.race_config": ("RaceConfig",),
    "app.runs.racing": ("record_race",),
    "app.runs.results": ("race_result",),
    "app.runs.tables": ("from_bytes", "snapshot"),
    "app.runs.training": ("train",),
}
"""Names that the programs use, by module."""


def _imports(text: str) -> str:
    lines = []
    for module, names in _MODULES.items():
        used = [name for name in names if f"{name}(" in text or f"{name})" in text]
        if used:
            lines.append(f"from {module} import {', '.join(used)}")
    return "\n".join(lines)


def _file(training_id: str) -> str:
    return f"q-{training_id}.npz"


def _variable(training_id: str) -> str:
    return f"table_{training_id}"


def _lines(commands: Iterable[str]) -> str:
    return "\n".join(commands) + "\n"


# ---- arguments: of commands as (option, text), of Python as name and expression


def _training_command(run: Run, config: TrainingConfig) -> str:
    options = [*_walk_options(config)]
    if config.observation != TrainingConfig.observation:
        options.append(("--observation", config.observation))
    defaults = {one.name: one.default for one in fields(TrainingConfig)}
    for name in [name for name in defaults if name not in _NOT_IN_COMMANDS]:
        value = getattr(config, name)
        if name == "steps" or (name != "observation" and value != defaults[name]):
            options.append((_flag(name), _text(value)))
    if run.continued_from is None:
        options.append(("--seed", str(config.seed)))
    else:
        options.append(("--from", _file(run.continued_from)))
    if config.agent != TrainingConfig.agent:
        options.append(("--agent", config.agent))
    own = _differing(config.agent, config.settings)
    options += [(_flag(name), _text(value)) for name, value in own.items()]
    return _command("hexapods train", [*options, ("--out", _file(run.id))])


def _race_command(run: Run, config: RaceConfig) -> str:
    options = [*_walk_options(config)]
    for lane, training_id in zip(config.lanes, run.lane_training_ids, strict=True):
        head = lane.agent if training_id is None else f"{lane.agent}={_file(training_id)}"
        given = _lane_settings(lane, training_id is not None)
        options.append(("--lane", ",".join([head, *(f"{k}={_text(v)}" for k, v in given.items())])))
    return _command(
        "hexapods race", [*options, ("--steps", str(config.steps)), ("--seed", str(config.seed))]
    )


def _walk_options(config: WalkingProblem) -> Iterable[tuple[str, str]]:
    shown = as_json(config)
    gait = shown["gait"]
    yield "--gait", gait if isinstance(gait, str) else json.dumps(gait)
    if config.robot != WalkingProblem(gait="left-right-origin").robot:
        is_preset = config.robot in PRESETS.values()
        yield "--robot", config.robot.name if is_preset else json.dumps(shown["robot"])
    for name in ("simulator", "divisions", "grid_side_m", "tolerance"):
        if getattr(config, name) != _WALK[name]:
            yield _flag(name), _text(getattr(config, name))
    for one in config.world.disturbances:
        yield "--disturb", as_text(one)


def _walk_arguments(config: WalkingProblem) -> dict[str, str]:
    shown = as_json(config)
    arguments = {"gait": repr(config.gait)}
    if config.robot != WalkingProblem(gait="left-right-origin").robot:
        arguments["robot"] = f"robot({robot_as_mapping(config.robot)!r})"
    for name in ("simulator", "divisions", "grid_side_m", "tolerance"):
        if getattr(config, name) != _WALK[name]:
            arguments[name] = repr(getattr(config, name))
    if config.world:
        arguments["world"] = f"world({pformat(shown['disturbances'], sort_dicts=False)})"
    return arguments


def _training_arguments(config: TrainingConfig) -> dict[str, str]:
    defaults = {one.name: one.default for one in fields(TrainingConfig)}
    names = [name for name in defaults if name not in (*_WALK, "pace", "agent", "settings")]
    always = ("steps", "seed")
    given = {name: getattr(config, name) for name in names}
    own = {k: repr(v) for k, v in given.items() if k in always or v != defaults[k]}
    return {**_walk_arguments(config), **own}


def _own_settings(agent: str, settings: Mapping[str, Value]) -> dict[str, str]:
    return {name: repr(value) for name, value in _differing(agent, settings).items()}


def _differing(agent: str, settings: Mapping[str, Value]) -> dict[str, Value]:
    """Return the settings that are not the agent's defaults; all of an agent that is unknown."""
    try:
        defaults = {name: one.default for name, one in agent_settings(agent).items()}
    except HexapodError:
        defaults = {}
    return {
        name: value
        for name, value in settings.items()
        if value is not None and (name not in defaults or value != defaults[name])
    }


def _lane_settings(lane: LaneConfig, has_training: bool) -> dict[str, Value]:
    given: dict[str, Value] = {}
    if lane.keep_learning != _keeps_learning(lane.agent):
        given["keep_learning"] = lane.keep_learning
    if lane.plans_with is not None:
        given["plans_with"] = lane.plans_with
    if not has_training and lane.observation != LaneConfig.observation:
        given["observation"] = lane.observation
    return {**given, **_differing(lane.agent, lane.settings)}


def _keeps_learning(agent: str) -> bool:
    try:
        return keeps_learning(agent)
    except HexapodError:
        return False


def _race_python(run: Run, config: RaceConfig) -> str:
    lanes = []
    for lane, training_id in zip(config.lanes, run.lane_training_ids, strict=True):
        given = {k: repr(v) for k, v in _lane_settings(lane, training_id is not None).items()}
        if training_id is not None:
            given |= {"observation": repr(lane.observation), "has_training": "True"}
        text = ", ".join([repr(lane.agent), *(f"{k}={v}" for k, v in given.items())])
        lanes.append(f"        lane_config({text}),\n")
    tables = [None if one is None else _variable(one) for one in run.lane_training_ids]
    arguments = {
        **_walk_arguments(config),
        "lanes": f"(\n{''.join(lanes)}    )",
        "steps": repr(config.steps),
        "seed": repr(config.seed),
    }
    return "\n".join(
        [
            _call("config", "RaceConfig", arguments),
            f"walkers = build_walkers(config, [{', '.join(map(str, tables))}])",
            "*_, lanes = record_race(walkers, config, perf_counter)",
            "print(race_result(lanes, config.steps))",
        ]
    )


def _call(variable: str, function: str, arguments: Mapping[str, str]) -> str:
    lines = "".join(f"    {name}={text},\n" for name, text in arguments.items())
    return f"{variable} = {function}(\n{lines})"


def _command(program: str, options: Iterable[tuple[str, str]]) -> str:
    return " \\\n    ".join([program, *(f"{flag} {shlex.quote(text)}" for flag, text in options)])


def _flag(name: str) -> str:
    return f"--{name.replace('_', '-')}"


def _text(value: Any) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


# ---- experiments

_REPEATED = {"gaits": "--gait", "robots": "--robot", "agents": "--agent", "worlds": "--world"}


def _experiment_command(config: ExperimentConfig) -> str:
    options: list[tuple[str, str]] = []
    for name, value in _experiment_differences(config).items():
        if name in _REPEATED:
            options += [(_REPEATED[name], _part(one)) for one in value]
        elif name == "observations":
            options.append(("--observation", ",".join(value)))
        else:
            values = value if isinstance(value, list) else [value]
            options.append((_flag(name), ",".join(map(_text, values))))
    name = config.experiment
    program = "hexapods sweep" if name == "sweep" else f"hexapods experiment {name}"
    return _lines([_command(program, options)])


def _part(value: Any) -> str:
    if not isinstance(value, dict):
        return str(value)
    return str(value["preset"]) if set(value) == {"preset"} else json.dumps(value)


def _experiment_differences(config: ExperimentConfig) -> dict[str, Any]:
    """Return what differs from the defaults, of which some depend on simulator and agents."""
    name, shown = config.experiment, experiment_as_json(config)
    chosen: dict[str, Any] = {"simulator": config.simulator}
    if "agents" in fields_of(name):
        chosen["agents"] = config.agents
    usual = experiment_as_json(experiment_config(name, {}))
    expected = {
        **experiment_as_json(experiment_config(name, chosen)),
        **{field: usual[field] for field in chosen},
        "experiment": name,
    }
    always = ("seeds", "seed")
    return {k: v for k, v in shown.items() if k in always or v != expected.get(k)}


def _experiment_python(config: ExperimentConfig) -> str:
    name = f"{config.experiment}-results"
    given = pformat(experiment_as_json(config), sort_dicts=False, compact=True)
    indented = given.replace("\n", "\n    ")
    return (
        "from pathlib import Path\n"
        "from app.experiments.cluster import ClusterSpec\n"
        "from app.experiments.config import from_json\n"
        "from app.experiments.folder import open_results\n"
        "from app.experiments.summary import summarise\n"
        "\n"
        'if __name__ == "__main__":  # its trials have processes of their own\n'
        f"    config = from_json(\n        {indented}\n    )\n"
        f'    with open_results(Path("{name}"), config) as folder:\n'
        "        for _ in folder.run(folder.remaining(), ClusterSpec(), lambda: True):\n"
        "            pass\n"
        "        results, set_aside = folder.planned()\n"
        "        summary = summarise(config, results, set_aside, folder.cost(None))\n"
        '        print([(one["key"], one["total"]["iqm_m"]) for one in summary["settings"]])\n'
    )
