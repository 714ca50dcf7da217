"""Trainings: practise, go on, evaluate, save.

`train` and `iter_train` run the loop of `hexapods.runs.training`, which the dashboard runs too: the
same arguments and seed give the same action values, to the last bit.
"""

import html
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple, Union, cast

from hexapods.agents.protocol import Agent, Tunable
from hexapods.agents.registry import AgentClass, needs_practice
from hexapods.arguments import (
    WALK,
    agent_name,
    check_names,
    plain_values,
    read_disturbance,
    read_walk,
)
from hexapods.assembly import build_learner, finish_training
from hexapods.domain.checks import check_whole
from hexapods.domain.errors import DamagedFile, InvalidInput
from hexapods.domain.world import check_ends
from hexapods.files import write_atomically
from hexapods.runs import training
from hexapods.runs.config import (
    TrainingConfig,
    agent_settings,
    changeable_settings,
    training_config,
)
from hexapods.runs.config_json import config_from_json
from hexapods.runs.records import Evaluated, TrainingRecord
from hexapods.runs.results import TrainingResult
from hexapods.runs.tables import Checkpoint, check_fits, from_bytes, load_agent, snapshot, to_bytes

_FIELDS = tuple(
    one.name
    for one in fields(TrainingConfig)
    # Practice here is as fast as it can be; settings are arguments of their own.
    if one.name not in (*WALK, "agent", "pace", "settings")
)
Table = Union["Training", str, Path]
"""What was learned: a training, or the path of its file."""
OnRecord = Callable[[TrainingRecord], object]


class CurvePoint(NamedTuple):
    """An evaluation: distance in 50 steps from rest [m], after `step` steps of practice."""

    step: int
    distance_m: float
    epsilon: float
    """ε of the practice at that step."""


@dataclass(frozen=True, repr=False, eq=False)
class Training:
    """A finished training, as `train` and `load` return it.

    Attributes:
        config: all that decides its result.
        table: what it learned, with its generator: a checkpoint.
        curve: its evaluations, in order; `pandas.DataFrame(training.curve)` takes them. None are
            known of a file that the dashboard wrote.
        result: distance, references and hash of the Q-table, as in answers of the dashboard; None
            of such a file.
    """

    config: TrainingConfig
    table: Checkpoint
    curve: tuple[CurvePoint, ...] = ()
    result: TrainingResult | None = None

    @property
    def distance_m(self) -> float | None:
        """Distance in 50 steps from rest, after the practice [m]; None if it is not known."""
        return None if self.result is None else self.result.distance_m

    @property
    def greedy_distance_m(self) -> float | None:
        """Distance of the one-step look-ahead agent in as many steps [m]; None if not known."""
        return None if self.result is None else self.result.greedy_distance_m

    @property
    def best_known_m(self) -> float | None:
        """Distance of the farthest walk known of this problem [m]; None if none is."""
        return None if self.result is None else self.result.best_known_m

    @property
    def q_table_sha256(self) -> str | None:
        """Hash of the Q-table; None for an agent without one, or if it is not known."""
        return None if self.result is None else self.result.q_table_sha256

    @cached_property
    def agent(self) -> Agent:
        """An agent with what was learned, of the agent's own class; it does not explore."""
        learner = build_learner(self.config)
        load_agent(learner.walker.agent, self.table)
        return learner.walker.agent

    def __getstate__(self) -> dict[str, Any]:
        """Return what is pickled: an agent holds its simulator, and can be made again."""
        return {name: value for name, value in self.__dict__.items() if name != "agent"}

    def to_bytes(self) -> bytes:
        """Return the content of the `.npz` file that `save` writes."""
        meta = dict(self.table.meta)
        if self.result is not None:
            meta |= {"curve": [list(one) for one in self.curve], "result": asdict(self.result)}
        return to_bytes(Checkpoint(meta, self.table.arrays))

    def save(self, path: str | Path) -> Path:
        """Write the table to an `.npz` file, which `load`, the dashboard and the command line read.

        Returns:
            the path.

        Raises:
            OSError: if the file cannot be written.
        """
        target = Path(path)
        write_atomically(target, self.to_bytes())
        return target

    def __repr__(self) -> str:
        steps = self.table.meta["step"]
        return f"<Training of {self.config.agent}: {steps:,} steps, {_metres(self.distance_m)}>"

    def _repr_html_(self) -> str:
        rows = {
            "agent": self.config.agent,
            "steps of practice": f"{self.table.meta['step']:,}",
            "distance in 50 steps": _metres(self.distance_m),
            "one-step look-ahead": _metres(self.greedy_distance_m),
            "best known walk": _metres(self.best_known_m),
        }
        cells = "".join(f"<tr><th>{k}</th><td>{html.escape(v)}</td></tr>" for k, v in rows.items())
        return f"<table>{cells}</table>"


def train(
    agent: str | AgentClass | None = None,
    *,
    table: Table | None = None,
    changes: Iterable[Mapping[str, Any]] = (),
    on_record: OnRecord | None = None,
    **given: Any,
) -> Training:
    """Train an agent to walk (paper, Algorithm 1), and evaluate what it learned.

    Args:
        agent: its registered name, such as `q-learning`, `my.module:Agent`, or its class; by
            default that of `table`, or Q-learning.
        table: what it begins with; then its generator goes on where the table's ended. Gait, robot,
            simulator, grid and observation are those of its practice unless they are given, and the
            settings the agent's defaults.
        changes: while it practises: mappings with the number of steps after which they happen,
            `step`, and values of the agent's live `settings` by name, or a `disturbance`.
        on_record: called with each record of the loop.
        given: fields of `TrainingConfig`: the walking problem's (`gait`, a name or a `Gait`;
            `robot`, a preset's name, a mapping or a `Robot`; `simulator`, `divisions`,
            `grid_side_m`, `tolerance`; `world`, a name, disturbances or a `World`), `steps`,
            `seed`, `observation`, `steps_per_episode`, `evaluate_every`, and the agent's settings.

    Raises:
        UnknownName, InvalidInput: if an argument is not valid; the message names what is.
        TableMismatch: if the table is of another walking problem or agent.
        Diverged: if the physics diverges.
    """
    practice = _Practice(agent, table, changes, given)
    curve = []
    for record in practice.records(is_recorded=False):
        if isinstance(record, Evaluated):
            curve.append(CurvePoint(record.step, record.distance_m, record.epsilon))
        if on_record is not None:
            on_record(record)
    learner, config = practice.learner, practice.config
    result = finish_training(learner, config)
    return Training(config, snapshot(learner, config), tuple(curve), result)


def iter_train(
    agent: str | AgentClass | None = None,
    *,
    table: Table | None = None,
    changes: Iterable[Mapping[str, Any]] = (),
    record: bool = False,
    **given: Any,
) -> Iterator[TrainingRecord]:
    """Train an agent, and yield a record of each step, episode and evaluation as it happens.

    With `record`, steps and evaluations have their motion, and steps the action values; all else is
    as in `train`.

    Raises:
        UnknownName, InvalidInput, TableMismatch: at the call, as `train`.
        Diverged: if the physics diverges.
    """
    return _Practice(agent, table, changes, given).records(record)


def evaluate(
    agent: str | AgentClass | Training, *, table: Table | None = None, **given: Any
) -> float:
    """Return how far an agent walks in 50 steps from rest, without exploring or learning [m].

    Args:
        agent: a training, or an agent's name or class.
        table: what the agent has learned, unless `agent` is a training.
        given: as in `train`; what is not given is as in the training, except for the world. Like
            the evaluations of a training it walks in the world as it is after the practice, which
            does not change meanwhile.

    Raises:
        UnknownName, InvalidInput, TableMismatch, Diverged: as `train`.
    """
    if isinstance(agent, Training):
        table, agent = agent, agent.config.agent
    trained = None if table is None else read_table(table)
    if trained is None and needs_practice(agent_name(agent)):
        raise InvalidInput(f"{agent_name(agent)} walks with what it has learned: give its training")
    if trained is not None:
        like = {"steps": trained.config.steps, "tolerance": trained.config.tolerance}
        given = {**_own_settings(trained.config), **like, **given}
    config = _config(agent, trained, given)
    learner = build_learner(config)
    if trained is not None:
        check_fits(trained.table, config, config.observation)
        load_agent(learner.walker.agent, trained.table)
        learner.step = trained.table.meta["step"]
    return training.evaluate(learner, config, epsilon=0.0).distance_m


def read_table(table: Table) -> Training:
    """Return a training, read from its file if it is given by its path.

    Raises:
        InvalidInput: if the file cannot be read.
        DamagedFile: if it is no table, or was changed since it was written.
    """
    if isinstance(table, Training):
        return table
    if not isinstance(table, str | Path):
        raise InvalidInput(f"a table is a training or the path of its file, not {table!r}")
    try:
        data = Path(table).read_bytes()
    except OSError as error:
        raise InvalidInput(f"cannot read the table {table}: {error.strerror}") from error
    return training_from_bytes(data, str(table))


def training_from_bytes(data: bytes, name: str) -> Training:
    """Decode the file of a training.

    Args:
        data: its content.
        name: its name, for error messages.

    Raises:
        DamagedFile: if it is no table, or was changed since it was written.
    """
    checkpoint = from_bytes(data, name)
    try:
        config = config_from_json(checkpoint.meta["config"])
        curve = tuple(CurvePoint(*point) for point in checkpoint.meta.get("curve", ()))
        fields = checkpoint.meta.get("result")
        result = None if fields is None else TrainingResult(**fields)
    except (KeyError, TypeError, ValueError) as error:
        raise DamagedFile(f"{name} does not say how it was learned: {error}") from error
    if not isinstance(config, TrainingConfig):
        raise DamagedFile(f"{name} is not that of a training")
    return Training(config, checkpoint, curve, result)


class _Practice:
    """A training that is under way: its learner, and the changes that are to come."""

    def __init__(
        self,
        agent: str | AgentClass | None,
        table: Table | None,
        changes: Iterable[Mapping[str, Any]],
        given: Mapping[str, Any],
    ) -> None:
        trained = None if table is None else read_table(table)
        self.config = _config(agent, trained, given)
        check_ends(self.config.world.disturbances, self.config.steps)
        self._changes = _read_changes(changes, self.config)
        self.learner = build_learner(self.config, None if trained is None else trained.table)

    def records(self, is_recorded: bool) -> Iterator[TrainingRecord]:
        self._change()
        for record in training.train(self.learner, self.config, is_recorded):
            self._change()
            yield record

    def _change(self) -> None:
        while self._changes and self._changes[0]["step"] <= self.learner.step:
            values = self._changes.pop(0)
            if "disturbance" in values:
                self.learner.disturb(values["disturbance"], self.config)
            if values["settings"]:
                # `_read_changes` has looked for settings that are live.
                cast(Tunable, self.learner.walker.agent).tune(**values["settings"])


def _read_changes(changes: Iterable[object], config: TrainingConfig) -> list[dict[str, Any]]:
    """Return changes that happen while a training runs, checked."""
    live = {k: v for k, v in changeable_settings(config.agent).items() if k != "pace"}
    read: list[dict[str, Any]] = []
    for change in changes:
        if not isinstance(change, Mapping) or "step" not in change:
            raise InvalidInput(
                'a change is a mapping such as {"step": 20, "settings": {"alpha": 0.1}}, not '
                f"{change!r}"
            )
        values = plain_values(change)
        check_names("a change", values, ("step", "settings", "disturbance"))
        settings = values.setdefault("settings", {})
        if not isinstance(settings, Mapping):
            raise InvalidInput(
                f'settings of a change are such as {{"alpha": 0.1}}, not {settings!r}'
            )
        if settings and not live:
            raise InvalidInput(f"{config.agent} has no settings that change in practice")
        check_names(f"a change of {config.agent}", settings, live)
        check_whole(
            "step of a change", values["step"], read[-1]["step"] if read else 0, config.steps
        )
        if "disturbance" in values:
            values["disturbance"] = read_disturbance(values["disturbance"])
        values["settings"] = {k: live[k].normalized(v) for k, v in settings.items()}
        read.append(values)
    return read


def _config(
    agent: str | AgentClass | None, trained: Training | None, given: Mapping[str, Any]
) -> TrainingConfig:
    """Return the config of a training; what is not given is the table's, or the default."""
    if agent is None:
        name = TrainingConfig.agent if trained is None else trained.config.agent
    else:
        name = agent_name(agent)
    settings = agent_settings(name)
    check_names("a training", given, (*WALK, *_FIELDS, *settings))
    given = plain_values(given)
    walk = {key: value for key, value in given.items() if key in WALK}
    rest: dict[str, Any] = {key: value for key, value in given.items() if key not in WALK}
    like = None
    if trained is not None:
        like = trained.config
        rest = {"observation": like.observation, "seed": like.seed, **rest}
    return training_config(name, **read_walk(walk, like), **rest)


def _own_settings(config: TrainingConfig) -> dict[str, Any]:
    """Return the settings of a training's agent; earlier versions stored those of others too."""
    declared = agent_settings(config.agent)
    return {name: value for name, value in config.settings.items() if name in declared}


def _metres(value: float | None) -> str:
    return "not known" if value is None else f"{value:.2f} m"
