"""The verbs of trainings: `train`, `iter_train` and `evaluate`."""

import os
import signal
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any, cast

from hexapods.agents.protocol import Tunable
from hexapods.agents.registry import AgentClass, check_unattended, needs_practice
from hexapods.arguments import (
    NOT_GIVEN,
    WALK,
    GaitLike,
    RobotLike,
    WorldLike,
    agent_name,
    check_callable,
    check_names,
    check_savable,
    given_arguments,
    plain,
    read_walk,
)
from hexapods.assembly import build_learner
from hexapods.changes import LATER, change_as_json, read_changes
from hexapods.domain.errors import DamagedFile, InvalidInput
from hexapods.domain.observation import Observation
from hexapods.domain.simulator import RewardKind
from hexapods.domain.world import check_ends
from hexapods.files import path_of, write_atomically
from hexapods.interruption import Interrupted, stop_signals
from hexapods.runs import training
from hexapods.runs.config import (
    SimulatorName,
    TrainingConfig,
    agent_settings,
    training_config,
)
from hexapods.runs.presses import apply_presses
from hexapods.runs.records import Evaluated, TrainingRecord
from hexapods.runs.results import training_result
from hexapods.runs.tables import Checkpoint, check_fits, load_agent, restore, snapshot, to_bytes
from hexapods.runs.training import Learner
from hexapods.trainings import CurvePoint, Table, Training, learned_by, read_table

FIELDS = tuple(
    field.name
    for field in fields(TrainingConfig)
    # Practice here is as fast as it can be; agent and settings are arguments of their own.
    if field.name not in ("agent", "pace", "settings")
)
"""Names of the arguments that are fields of a training."""
OnRecord = Callable[[TrainingRecord], object]


def train(
    agent: str | AgentClass | None = None,
    *,
    table: Table | None = None,
    changes: Iterable[Mapping[str, Any]] = (),
    on_record: OnRecord | None = None,
    checkpoint: str | os.PathLike[str] | None = None,
    gait: GaitLike = NOT_GIVEN,
    robot: RobotLike = NOT_GIVEN,
    simulator: SimulatorName = NOT_GIVEN,
    divisions: int = NOT_GIVEN,
    grid_side_m: float = NOT_GIVEN,
    world: WorldLike = NOT_GIVEN,
    tolerance: float = NOT_GIVEN,
    reward: RewardKind = NOT_GIVEN,
    steps: int = NOT_GIVEN,
    seed: int = NOT_GIVEN,
    observation: Observation = NOT_GIVEN,
    steps_per_episode: int = NOT_GIVEN,
    evaluate_every: int = NOT_GIVEN,
    **settings: Any,
) -> Training:
    """Train an agent to walk (paper, Algorithm 1), and evaluate the learned policy.

    Args:
        agent: its registered name, such as `q-learning`, `my.module:Agent`, or its class; by
            default that of `table`, or Q-learning.
        table: training to begin with, or its file; its generator goes on where that ended. Gait,
            robot, simulator, grid and observation are those of its practice unless they are given,
            and the settings the agent's defaults.
        changes: changes during the practice: mappings with the number of steps after which they
            happen, `step`, and values of the agent's live `settings` by name, a `disturbance`, or
            `presses` of those who watch: pairs of the steps done in the picture and a value from
            −1 to 1, for an agent that learns from them, such as `tamer`.
        on_record: called with each record of the loop.
        checkpoint: path of a file that keeps the state between two steps if the training is
            interrupted by Ctrl-C, or `on_record` raises: `resume` goes on from there, exactly. A
            second Ctrl-C ends at once.
        gait: a name, such as `left-right-origin` (default), or a `Gait` or its fields.
        robot: a preset's name, `stiff` (default), `compliant` or `slippery`, or a `Robot`, or what
            differs from a preset.
        simulator: `mujoco` (default), or `kinematic`: ideal, without slip.
        divisions: points along each side of the foot grid, 2.
        grid_side_m: side of the foot grid, 0.04 [m].
        world: a name, such as `ice`, a list of disturbances, or a `World`; by default flat ground.
        tolerance: how far the robot that the seed draws differs from its design, as a share.
        reward: displacement that a step's reward is: `forward` (default), along the robot's own
            heading, or `track`, along the track.
        steps: number of steps of practice, 500.
        seed: seed of all random generators, 0.
        observation: how the state is read: `measured` (default), `commanded` or `planned`.
        steps_per_episode: number of steps for which ε is constant, 50.
        evaluate_every: steps between two evaluations, 50; 0 for none.
        settings: those that the agent's constructor declares, such as `alpha`.

    Raises:
        UnknownName, InvalidInput: if an argument is not valid; the message names what is.
        TableMismatch: if the table is of another walking problem or agent.
        Diverged: if the physics diverges.
        Interrupted: a `KeyboardInterrupt`, once the checkpoint is written.

    Examples:
        >>> import hexapods as hx
        >>> training = hx.train("q-learning", steps=100, seed=0, simulator="kinematic")
        >>> training
        <Training of q-learning: 100 steps, 0.24 m>
        >>> [(point.step, round(point.distance_m, 2)) for point in training.curve]
        [(50, 0.04), (100, 0.24)]
    """
    check_callable("on_record", on_record)
    path = None if checkpoint is None else path_of(checkpoint, "a checkpoint")
    practice = _begun(agent, table, changes, given_arguments(locals(), FIELDS, "settings"))
    return _run(practice, on_record, path)


def resume(
    checkpoint: str | os.PathLike[str] | Training,
    *,
    on_record: OnRecord | None = None,
) -> Training:
    """Go on with a training that was interrupted; the result is that of the unbroken one.

    Table, generators and the robot are in the state in which they were, so that it is equal to the
    last bit. Interrupted again, it is kept in the same file.

    Args:
        checkpoint: path of the file that `train` has kept, or that `Training.save` has of a
            training that was not finished, or such a training itself.
        on_record: called with each further record of the loop.

    Raises:
        InvalidInput: if the file cannot be read.
        DamagedFile: if it is no table, or was changed since it was written.
        Diverged: if the physics diverges.
        Interrupted: as `train`.

    Examples:
        >>> import hexapods as hx
        >>> problem = {"steps": 100, "seed": 0, "simulator": "kinematic"}
        >>> practice = hx.iter_train("sarsa", **problem)
        >>> while practice.step < 40:
        ...     _ = next(practice)
        >>> path = practice.training.save("half.npz")
        >>> hx.resume(path).distance_m == hx.train("sarsa", **problem).distance_m
        True
    """
    check_callable("on_record", on_record)
    interrupted = read_table(checkpoint)
    later = interrupted.table.meta.get(LATER, ())
    practice = Practice(interrupted.config, None, later, interrupted=interrupted)
    path = None if isinstance(checkpoint, Training) else path_of(checkpoint, "a checkpoint")
    return _run(practice, on_record, path)


def _begun(
    agent: str | AgentClass | None,
    table: Table | None,
    changes: Iterable[Mapping[str, Any]],
    fields_and_settings: Mapping[str, Any],
    record: bool = False,
) -> "Practice":
    """Return a practice that begins.

    Args:
        agent: as in `train`, and so is all but the following.
        table: training to begin with, or its file.
        changes: changes during the practice.
        fields_and_settings: fields of the config, and the agent's settings.
        record: see `iter_train`.
    """
    if agent is None:
        trained = None if table is None else read_table(table)
        name = TrainingConfig.agent if trained is None else trained.config.agent
    else:
        name, trained = learned_by(agent_name(agent), table)
    config = check_savable(config_of(name, trained, fields_and_settings))
    check_ends(config.world.disturbances, config.steps)
    practice = Practice(config, None if trained is None else trained.table, changes, record)
    if not practice.has_presses:
        check_unattended(name, config.settings)
    return practice


def _restore(learner: Learner, interrupted: Training) -> None:
    try:
        restore(learner, interrupted.table)
    except InvalidInput:
        raise
    except (KeyError, TypeError, ValueError) as error:
        raise DamagedFile(f"the training has no state to go on from: {error}") from error


def _run(practice: "Practice", on_record: OnRecord | None, path: Path | None) -> Training:
    """Run a practice to its end, or until it is interrupted; then keep it in a file, if one is."""
    if path is None:
        for record in practice:
            if on_record is not None:
                on_record(record)
        return practice.training
    with stop_signals(signal.SIGINT) as interrupted:
        for record in practice:
            try:
                if on_record is not None:
                    on_record(record)
            except BaseException as error:
                write_atomically(path, to_bytes(practice.checkpoint))
                error.add_note(f"The training is kept: hexapods.resume({str(path)!r}) goes on.")
                raise
            if interrupted.is_set() and not practice.is_complete:
                write_atomically(path, to_bytes(practice.checkpoint))
                raise Interrupted(path, practice.step, practice.config.steps)
        return practice.training


def iter_train(
    agent: str | AgentClass | None = None,
    *,
    table: Table | None = None,
    changes: Iterable[Mapping[str, Any]] = (),
    record: bool = False,
    gait: GaitLike = NOT_GIVEN,
    robot: RobotLike = NOT_GIVEN,
    simulator: SimulatorName = NOT_GIVEN,
    divisions: int = NOT_GIVEN,
    grid_side_m: float = NOT_GIVEN,
    world: WorldLike = NOT_GIVEN,
    tolerance: float = NOT_GIVEN,
    reward: RewardKind = NOT_GIVEN,
    steps: int = NOT_GIVEN,
    seed: int = NOT_GIVEN,
    observation: Observation = NOT_GIVEN,
    steps_per_episode: int = NOT_GIVEN,
    evaluate_every: int = NOT_GIVEN,
    **settings: Any,
) -> "Practice":
    """Train an agent, and yield a record of each step, episode and evaluation as it happens.

    With `record`, steps and evaluations have their motion, and steps the action values; all else is
    as in `train`.

    Returns:
        an iterator over the records, whose `training` is the result.

    Raises:
        UnknownName, InvalidInput, TableMismatch: at the call, as `train`.
        Diverged: if the physics diverges.

    Examples:
        >>> import hexapods as hx
        >>> practice = hx.iter_train("q-learning", steps=100, seed=0, simulator="kinematic")
        >>> for record in practice:
        ...     if isinstance(record, hx.Evaluated):
        ...         print(record.step, round(record.distance_m, 2))
        50 0.04
        100 0.24
        >>> practice.training
        <Training of q-learning: 100 steps, 0.24 m>
    """
    return _begun(agent, table, changes, given_arguments(locals(), FIELDS, "settings"), record)


def evaluate(
    agent: str | AgentClass | Training,
    *,
    table: Table | None = None,
    gait: GaitLike = NOT_GIVEN,
    robot: RobotLike = NOT_GIVEN,
    simulator: SimulatorName = NOT_GIVEN,
    divisions: int = NOT_GIVEN,
    grid_side_m: float = NOT_GIVEN,
    world: WorldLike = NOT_GIVEN,
    tolerance: float = NOT_GIVEN,
    reward: RewardKind = NOT_GIVEN,
    steps: int = NOT_GIVEN,
    seed: int = NOT_GIVEN,
    observation: Observation = NOT_GIVEN,
    steps_per_episode: int = NOT_GIVEN,
    evaluate_every: int = NOT_GIVEN,
    **settings: Any,
) -> float:
    """Return an agent's distance in 50 steps from rest, without exploring or learning [m].

    Like the evaluations of a training it walks in the world as it is after the practice, which does
    not change meanwhile.

    Args:
        agent: a training, or an agent's name or class.
        table: training of the agent, or its file, unless `agent` is a training.
        gait: as in `train`, and so are all below; what is not given is as in the
            training.
        robot: geometry and actuators.
        simulator: `mujoco` or `kinematic`.
        divisions: points along each side of the foot grid.
        grid_side_m: side of the foot grid [m].
        world: disturbances of the robot and the ground; by default undisturbed.
        tolerance: how far the robot that the seed draws differs from its design, as a share.
        reward: displacement that a step's reward is.
        steps: number of steps of the practice.
        seed: seed of all random generators.
        observation: how the state is read.
        steps_per_episode: number of steps for which ε is constant.
        evaluate_every: steps between two evaluations.
        settings: settings of the agent.

    Raises:
        UnknownName, InvalidInput: if an argument is not valid; the message names what is.
        TableMismatch: if the table is of another walking problem or agent.
        Diverged: if the physics diverges.

    Examples:
        >>> import hexapods as hx
        >>> round(hx.evaluate("greedy", simulator="kinematic"), 2)
        0.5
        >>> training = hx.train("q-learning", steps=100, seed=0, simulator="kinematic")
        >>> hx.evaluate(training) == training.distance_m
        True
    """
    fields_and_settings = given_arguments(locals(), FIELDS, "settings")
    name, trained = learned_by(agent, table)
    if trained is None and needs_practice(name):
        raise InvalidInput(f"{name} walks with what it has learned: give its training")
    if trained is not None:
        like = {"steps": trained.config.steps, "tolerance": trained.config.tolerance}
        fields_and_settings = {**trained.config.settings, **like, **fields_and_settings}
    config = config_of(name, trained, fields_and_settings)
    learner = build_learner(config)
    if trained is not None:
        check_fits(trained.table, config, config.observation)
        load_agent(learner.walker.agent, trained.table)
        learner.step = trained.table.meta["step"]
    return training.evaluate(learner, config, epsilon=0.0).distance_m


class Practice(Iterator[TrainingRecord]):
    """A training that is under way, as `iter_train` returns it: an iterator over its records.

    Attributes:
        config: config of the training, which decides its result.
    """

    def __init__(
        self,
        config: TrainingConfig,
        table: Checkpoint | None,
        changes: Iterable[object],
        record: bool = False,
        interrupted: Training | None = None,
    ) -> None:
        """Build the learner.

        Args:
            config: config of the training.
            table: checkpoint to begin with.
            changes: changes during the practice.
            record: see `iter_train`.
            interrupted: state of an interrupted training to continue; then `changes` are those that
                are still to be made.
        """
        self.config = config
        self._changes = read_changes(changes, config)
        self._made: list[dict[str, Any]] = []
        self._learner = build_learner(config, table)
        self._records = training.train(self._learner, config, record)
        self._curve: list[CurvePoint] = []
        if interrupted is not None:
            _restore(self._learner, interrupted)
            self._made += interrupted.table.meta.get("changes", ())
            self._curve += interrupted.curve
        self._change()

    @property
    def step(self) -> int:
        """Number of steps done."""
        return self._learner.step

    @property
    def has_presses(self) -> bool:
        """Whether people press in it, by its changes."""
        return any("presses" in change for change in (*self._made, *self._changes))

    @property
    def is_complete(self) -> bool:
        """Whether all steps are done, and the last evaluation."""
        return self.step == self.config.steps and self._learner.due_epsilon is None

    @property
    def checkpoint(self) -> Checkpoint:
        """Complete state of the practice between two records, from which it is resumed exactly."""
        lists = {
            "curve": [list(point) for point in self._curve],
            "changes": self._made,
            LATER: [change_as_json(change) for change in self._changes],
        }
        filled = {name: values for name, values in lists.items() if values}
        return snapshot(self._learner, self.config, **filled)

    @property
    def training(self) -> Training:
        """The training so far; at the end it is the one that `train` returns.

        Before the end its reference distance is known only if it was measured already. If the
        learned policy cannot be evaluated, a warning says so, and the result is None.
        """
        learner, config = self._learner, self.config
        is_done = learner.step == config.steps
        try:
            result = training_result(learner, config, measure_reference=is_done)
        except Exception as error:  # of the agent, or of the physics: the practice is not lost
            result = None
            reason = f"{type(error).__name__}: {error}"
            warnings.warn(f"what was learned cannot be evaluated ({reason})", stacklevel=2)
        return Training(config, self.checkpoint, tuple(self._curve), result)

    def __next__(self) -> TrainingRecord:
        record = next(self._records)
        if isinstance(record, Evaluated):
            self._curve.append(CurvePoint(record.step, record.distance_m, record.epsilon))
        self._change()
        return record

    def _change(self) -> None:
        while self._changes and self._changes[0]["step"] <= self._learner.step:
            values = self._changes.pop(0)
            self._made.append({**change_as_json(values), "step": self._learner.step})
            if "disturbance" in values:
                self._learner.disturb(values["disturbance"], self.config)
            if values["settings"]:
                # `_read_changes` has looked for settings that are live.
                cast(Tunable, self._learner.walker.agent).tune(**values["settings"])
            apply_presses(self._learner.walker.agent, values.get("presses", ()))

    def __repr__(self) -> str:
        config, step = self.config, self._learner.step
        return f"<Practice of {config.agent}: {step:,} of {config.steps:,} steps>"


def config_of(
    name: str, trained: Training | None, fields_and_settings: Mapping[str, Any]
) -> TrainingConfig:
    """Return the config of a training; what is not given is the table's, or the default."""
    check_names("a training", fields_and_settings, (*FIELDS, *agent_settings(name)))
    fields_and_settings = plain(fields_and_settings)
    walk = {key: value for key, value in fields_and_settings.items() if key in WALK}
    rest: dict[str, Any] = {
        key: value for key, value in fields_and_settings.items() if key not in WALK
    }
    like = None
    if trained is not None:
        like = trained.config
        rest = {"observation": like.observation, "seed": like.seed, **rest}
    return training_config(name, **read_walk(walk, like), **rest)
