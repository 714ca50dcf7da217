"""Validate requests to start runs, and build the runs to be queued from them."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Protocol, runtime_checkable

from app.storage.database.store import RunStore
from app.storage.run import Run
from app.storage.run_kind import added_kind
from app.storage.run_names import branch_name, race_name, training_name
from app.storage.stored_tables import load_table
from hexapods.agents.registry import check_problem, learns, needs_practice
from hexapods.domain.disturbances import Disturbance
from hexapods.domain.errors import InvalidInput, TableMismatch
from hexapods.domain.kinematics import check_reach
from hexapods.domain.observation import Observation
from hexapods.domain.world import check_ends
from hexapods.runs.config import TrainingConfig, WalkingProblem, problem_of
from hexapods.runs.lane import LaneConfig, check_lane, lane_config, observation_of
from hexapods.runs.race_config import Branch, RaceConfig
from hexapods.runs.tables import Checkpoint, check_fits


class Start(Protocol):
    """Request to start a run."""

    def runs(self, store: RunStore, new_id: Callable[[], str]) -> list[Run]:
        """Return the run to be queued, not stored yet, preceded by those that are part of it.

        Raises:
            InvalidInput, TableMismatch, NotFound, Conflict: if the run cannot be started.
        """


@runtime_checkable
class ManyPractices(Protocol):
    """Request to start a run of many practices, of which several are computed at once."""

    def practices(self) -> Iterable[tuple[TrainingConfig, int]]:
        """Yield configs, each with the number of steps that are computed of it.

        Raises:
            InvalidInput, UnknownName, Unreachable: if the run cannot be started.
        """

    def at_once(self, cores: int) -> int:
        """Return the number of practices that are computed at once on so many cores."""


@dataclass(frozen=True)
class TrainingStart:
    """Request to start a training.

    Attributes:
        config: the training; its seed is ignored if it continues another.
        name: name of the run; None for a generated one.
        continue_from: id of the training whose table it continues from.
        notes: notes of the run.
    """

    config: TrainingConfig
    name: str | None = None
    continue_from: str | None = None
    notes: str = ""

    def runs(self, store: RunStore, new_id: Callable[[], str]) -> list[Run]:
        """See `Start`."""
        config = self.config
        if not learns(config.agent):
            raise InvalidInput(f"{config.agent} does not learn, so it cannot be trained")
        check_training(config)
        check_ends(config.world.disturbances, config.steps)
        if self.continue_from is not None:
            table = load_table(store, self.continue_from)
            check_fits(table, config, config.observation)
            _check_agent(table, config.agent, self.continue_from)
            # Its learning generator goes on; evaluations take theirs from the seed that began it.
            config = replace(config, seed=table.meta["config"]["seed"])
        training = Run(
            id=new_id(),
            kind="training",
            name=self.name or training_name(config, is_continued=self.continue_from is not None),
            config=config,
            continued_from=self.continue_from,
            total=config.steps,
            notes=self.notes,
        )
        return [training]


@dataclass(frozen=True)
class LaneStart:
    """Request for a lane: with a training's table, with a training to run first, or neither.

    Attributes:
        given: values of other fields of the lane in the request, by name; see `lane_config`.
        settings: values of the agent's settings in the request, by name.
    """

    agent: str
    training_id: str | None = None
    training: TrainingStart | None = None
    given: Mapping[str, Any] = field(default_factory=dict)
    settings: Mapping[str, Any] = field(default_factory=dict)

    @property
    def has_training(self) -> bool:
        """Whether the lane uses the table of a training, which ended or is to run first."""
        return self.training_id is not None or self.training is not None


@dataclass(frozen=True)
class RaceStart:
    """Request to start a race."""

    walk: WalkingProblem
    lanes: Sequence[LaneStart]
    steps: int
    seed: int
    name: str | None = None
    notes: str = ""

    def runs(self, store: RunStore, new_id: Callable[[], str]) -> list[Run]:
        """See `Start`."""
        check_walk(self.walk)
        check_ends(self.walk.world.disturbances, self.steps)
        trainings: dict[int, Run] = {}
        lanes: list[LaneConfig] = []
        for number, lane in enumerate(self.lanes):
            try:
                lanes.append(_lane(lane, self.walk, store))
            except InvalidInput as error:
                raise InvalidInput(f"lane {number + 1}: {error}") from error
            if lane.training is not None:
                (trainings[number],) = lane.training.runs(store, new_id)
        config = RaceConfig(**vars(self.walk), lanes=tuple(lanes), steps=self.steps, seed=self.seed)
        ids = {number: training.id for number, training in trainings.items()}
        race = Run(
            id=new_id(),
            kind="race",
            name=self.name or race_name(config),
            config=config,
            lane_training_ids=tuple(
                ids.get(number, lane.training_id) for number, lane in enumerate(self.lanes)
            ),
            waiting_for=tuple(ids.values()),
            total=config.steps * len(lanes),
            notes=self.notes,
        )
        return [*trainings.values(), race]


@dataclass(frozen=True)
class BranchStart:
    """Request to branch off from a step of another race, with further disturbances.

    Attributes:
        branch: the race and its step.
        disturbances: disturbances from that step on or later.
        name: name of the run; None for a generated one.
    """

    branch: Branch
    disturbances: Sequence[Disturbance]
    name: str | None = None

    def runs(self, store: RunStore, new_id: Callable[[], str]) -> list[Run]:
        """Return a race that repeats another up to a step; see `Start`."""
        race_id, step = self.branch.race_id, self.branch.step
        original = store.get(race_id)
        config = original.config
        if not isinstance(config, RaceConfig):
            raise InvalidInput(f"{race_id} is not a race; branch_from takes the id of a race")
        is_whole = original.state == "finished"
        taken = config.steps if is_whole else original.done // len(config.lanes)
        if not 0 <= step < config.steps or step > taken:
            last = min(taken, config.steps - 1)
            raise InvalidInput(
                f"branch_from.step must be from 0 to {last:,}, not {step:,}: race {race_id} has "
                f"taken {taken:,} of {config.steps:,} steps, and at least one must be left"
            )
        for disturbance in self.disturbances:
            if disturbance.at_step < step:
                raise InvalidInput(
                    f"{disturbance.kind}: at_step must be at least {step:,}, where the race "
                    f"branches, not {disturbance.at_step:,}"
                )
        check_ends(self.disturbances, config.steps)
        world = config.world
        for disturbance in sorted(self.disturbances, key=lambda disturbance: disturbance.at_step):
            world = world.then(disturbance)
        for training_id in filter(None, original.lane_training_ids):
            load_table(store, training_id)
        branch = Run(
            id=new_id(),
            kind="race",
            name=self.name or branch_name(original.name, step),
            config=replace(config, world=world, branch_from=self.branch),
            lane_training_ids=original.lane_training_ids,
            total=original.total,
        )
        return [branch]


@dataclass(frozen=True)
class CopyStart:
    """Request to start a run again with its settings, as it was started.

    Attributes:
        original_id: id of the run, in any state. It is read when the copy is made: a request that
            is repeated with its key returns the copy, also if the original has been deleted since.
    """

    original_id: str

    def runs(self, store: RunStore, new_id: Callable[[], str]) -> list[Run]:
        """See `Start`."""
        original = store.get(self.original_id)
        config = original.config
        if isinstance(config, TrainingConfig):
            check_training(config)
        elif (kind := added_kind(original.kind)) is not None:
            kind.checked_total(config)
        else:
            for lane, training_id in zip(config.lanes, original.lane_training_ids, strict=True):
                check_lane(lane, has_training=training_id is not None)
            if config.branch_from is not None:
                store.get(config.branch_from.race_id)
        for training_id in filter(None, (*original.lane_training_ids, original.continued_from)):
            load_table(store, training_id)
        copy = Run(
            id=new_id(),
            kind=original.kind,
            name=original.name,
            config=config,
            lane_training_ids=original.lane_training_ids,
            continued_from=original.continued_from,
            workers=original.workers,
            tags=original.tags,
            total=original.total,
        )
        return [copy]


def check_training(config: TrainingConfig) -> None:
    """Check that the robot reaches its foot grid, and that the learner would fit into memory.

    Raises:
        Unreachable: if a leg cannot reach a cell.
        InvalidInput: if there are too many states, for a Q-table or for the agent.
    """
    check_walk(config)
    check_problem(config.agent, problem_of(config), config.settings)


def check_walk(walk: WalkingProblem) -> None:
    """Check that the robot reaches its foot grid.

    Raises:
        Unreachable: if a leg cannot reach a cell.
    """
    check_reach(walk.robot, walk.resolved_gait, walk.grid)


def _lane(lane: LaneStart, walk: WalkingProblem, store: RunStore) -> LaneConfig:
    """Return the config of a lane.

    Raises:
        InvalidInput, TableMismatch, NotFound, Conflict: if it cannot race.
    """
    if lane.has_training and not learns(lane.agent):
        raise InvalidInput(f"{lane.agent} does not learn, so it takes no table")
    if lane.training_id is not None and lane.training is not None:
        raise InvalidInput("give training_id or training, not both")
    practised: Observation | None = None
    if lane.training is not None:
        practised = lane.training.config.observation
    elif lane.training_id is not None:
        table = load_table(store, lane.training_id)
        check_fits(table, walk)
        _check_agent(table, lane.agent, lane.training_id)
        practised = table.meta["observation"]
    observation = observation_of(lane.given.get("observation"), practised)
    config = lane_config(
        lane.agent,
        has_training=lane.has_training,
        **{**lane.given, "observation": observation},
        **lane.settings,
    )
    if needs_practice(lane.agent) and not (lane.has_training or config.keep_learning):
        raise InvalidInput(
            f"{lane.agent} races with what it has learned: give training_id, a training that is "
            "finished or stopped, training, one that is to come first, or keep_learning"
        )
    if not lane.has_training:
        check_problem(lane.agent, problem_of(walk), config.settings)
    return config


def _check_agent(table: Checkpoint, agent: str, training_id: str) -> None:
    if table.meta["agent"] != agent:
        raise TableMismatch(
            f"training {training_id} is of {table.meta['agent']}, not of {agent}; choose one of "
            "the same agent"
        )
