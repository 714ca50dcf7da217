"""Races: lanes side by side, ranked under three clocks, saved and read again.

`race` runs the loop of `hexapods.runs.racing`, which the dashboard runs too: the same arguments and
seed give the same walks, to the last bit; only the measured times of decisions differ.
"""

import html
import io
import json
import os
import time
import zipfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple, Unpack

import numpy as np

from hexapods.agents.registry import AgentClass, needs_practice
from hexapods.arguments import (
    WALK,
    Walk,
    check_callable,
    check_names,
    check_savable,
    plain,
    read_walk,
)
from hexapods.assembly import build_walkers
from hexapods.domain.errors import DamagedFile, InvalidInput
from hexapods.domain.observation import Observation
from hexapods.domain.records import from_json, to_json
from hexapods.domain.settings import declared_fields
from hexapods.domain.world import check_ends
from hexapods.files import path_of, write_atomically
from hexapods.policies import Policy, PolicyAgent
from hexapods.race_tables import Standing, lane_table, step_table
from hexapods.result_table import ResultTable
from hexapods.runs.best_known import best_known_in_race_m
from hexapods.runs.clocks import Clock, check_clock
from hexapods.runs.config import RACE_STEPS, agent_settings, problem_of
from hexapods.runs.lane import LaneConfig, PlanningModel, lane_config, observation_of
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.race_file import race_arrays, race_recording
from hexapods.runs.racing import record_race
from hexapods.runs.recording import LaneRecording
from hexapods.runs.results import RaceResult, race_result
from hexapods.runs.tables import digest_of, read_arrays
from hexapods.trainings import Table, Training, learned_by, training_from_bytes

CONFIG = "config"
"""Array of a saved race with its config as JSON."""
_DIGEST = "digest"
_LANE_ARGUMENTS = ("table", *declared_fields(LaneConfig))


class Lane(NamedTuple):
    """A lane of a race, as `lane` returns it."""

    config: LaneConfig
    training: Training | None
    policy: Policy | None = None


@dataclass(frozen=True, repr=False, eq=False)
class Race:
    """A finished race, as `race` and `load` return it.

    Attributes:
        config: config of the race, which decides its result.
        recording: the steps of each lane.
        result: distances and ranks of the lanes, as in answers of the dashboard.
    """

    config: RaceConfig
    recording: Sequence[LaneRecording]
    result: RaceResult

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> "Race":
        """Return the race that `save` has saved.

        Raises:
            InvalidInput: if the file cannot be read.
            DamagedFile: if it is no race, or was changed since it was written.
        """
        file = path_of(path, "a file")
        try:
            data = file.read_bytes()
        except OSError as error:
            raise InvalidInput(f"{file} cannot be read: {error.strerror}") from error
        return race_from_bytes(data, str(file))

    @property
    def standings(self) -> tuple[Standing, ...]:
        """The lanes by rank under the paper's clock; `pandas.DataFrame(race.standings)` is one."""
        return self.standings_under("paper")

    def standings_under(self, clock: Clock) -> tuple[Standing, ...]:
        """Return the lanes by rank under a clock.

        Args:
            clock: `paper`, `wall` or `free`; see `hexapods.runs.clocks`.

        Raises:
            UnknownName: if there is no such clock.
        """
        check_clock(clock)
        rows = [
            Standing(
                lane.clocks.under(clock).rank,
                number,
                lane.agent,
                lane.clocks.under(clock).finished_distance_m,
                lane.total_distance_m,
                lane.clocks.under(clock).elapsed_s,
            )
            for number, lane in enumerate(self.result.lanes)
        ]
        return tuple(sorted(rows, key=lambda row: (row.rank or len(rows), row.lane)))

    def table(self, clock: Clock = "paper") -> ResultTable:
        """Return the lanes by rank under a clock, a row each, with config and results.

        `pandas.DataFrame(race.table())` is a data frame, and so is one of polars. A lane that
        failed has its `failure` as the reason.

        Args:
            clock: `paper`, `wall` or `free`; see `hexapods.runs.clocks`.

        Raises:
            UnknownName: if there is no such clock.
        """
        return lane_table(self.config, self.result, self.standings_under(clock))

    def step_table(self) -> ResultTable:
        """Return all steps of all lanes, a row each, as `LaneStep` describes them.

        Of the action it has `group` and `cell`, of the observation `observed_0` and so on, the cell
        of each group.
        """
        return step_table(self.recording)

    @property
    def failed(self) -> Mapping[int, str]:
        """Reasons of the lanes that failed before their last step, by number from 0."""
        lanes = enumerate(self.result.lanes)
        return {number: lane.failure for number, lane in lanes if lane.failure is not None}

    @property
    def best_known_m(self) -> float | None:
        """The farthest walk known of this robot, gait and world [m]; None if none is."""
        return best_known_in_race_m(self.config)

    @property
    def recording_sha256(self) -> str | None:
        """Hash of all steps without the times of decisions: the same wherever the race repeats."""
        return self.result.recording_sha256

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write config and recording to an `.npz` file, which `load` reads.

        Returns:
            the path.

        Raises:
            InvalidInput: if it is no path.
            OSError: if the file cannot be written.
        """
        arrays = race_arrays(self.recording) | {CONFIG: np.array(json.dumps(to_json(self.config)))}
        buffer, target = io.BytesIO(), path_of(path, "a file")
        np.savez(buffer, **arrays, **{_DIGEST: np.array(digest_of(arrays))})  # type: ignore[arg-type]
        write_atomically(target, buffer.getvalue())
        return target

    def __repr__(self) -> str:
        ranking = ", ".join(
            f"{standing.agent} {self._failure(standing) or metres or 'without rank'}"
            for standing, metres in (
                (each, _metres(each.finished_distance_m)) for each in self.standings
            )
        )
        return f"<Race over {self.config.steps:,} steps: {ranking}>"

    def _failure(self, standing: Standing) -> str:
        """Return the failure of a lane in words; "" if it did not fail."""
        reason = self.failed.get(standing.lane)
        return "" if reason is None else f"failed: {reason}"

    def _repr_html_(self) -> str:
        head = ("rank", "agent", "at time-out", "total")
        rows = [
            (
                standing.rank,
                standing.agent,
                _metres(standing.finished_distance_m),
                self._failure(standing) or _metres(standing.total_distance_m),
            )
            for standing in self.standings
        ]
        cells = "".join(f"<th>{name}</th>" for name in head)
        body = "".join(
            "<tr>" + "".join(f"<td>{html.escape(str(value))}</td>" for value in row) + "</tr>"
            for row in rows
        )
        return f"<table><thead><tr>{cells}</tr></thead><tbody>{body}</tbody></table>"


def lane(
    agent: str | AgentClass | Training | Policy,
    *,
    table: Table | None = None,
    observation: Observation | None = None,
    keep_learning: bool | None = None,
    plans_with: PlanningModel | None = None,
    **settings: Any,
) -> Lane:
    """Return a lane for `race`.

    Args:
        agent: a training, an agent's name or class, or what `policy` returns, which takes no
            argument but `observation`.
        table: training of the agent, or its file, unless `agent` is a training.
        observation: observation mode; with a table that of its practice, else `measured`.
        keep_learning: whether it learns from each step of the race; None for its default.
        plans_with: model that a search plans with; see `LaneConfig`.
        settings: further fields of `LaneConfig`, and the agent's settings; none of these with a
            table, which has those of its practice.

    Raises:
        UnknownName, InvalidInput: if an argument is not valid; the message names what is.
        TableMismatch: if the table was learned by another agent.

    Examples:
        >>> import hexapods as hx
        >>> lanes = [hx.lane("look-ahead", depth=2), hx.lane("greedy", observation="planned")]
        >>> hx.race(lanes, simulator="kinematic", steps=6, seed=0).failed
        {}
    """
    if isinstance(agent, Policy):
        check_names("a policy's lane", settings, _LANE_ARGUMENTS)
        if table is not None or keep_learning or plans_with is not None:
            raise InvalidInput(
                "a policy does not learn and plans with no simulator; leave out table, "
                "keep_learning and plans_with"
            )
        return Lane(
            LaneConfig(agent=agent.name, observation=observation or "measured"), None, agent
        )
    name, trained = learned_by(agent, table)
    check_names(f"a {name} lane", settings, (*_LANE_ARGUMENTS, *agent_settings(name)))
    of_training = None if trained is None else trained.config.observation
    config = lane_config(
        name,
        observation=observation_of(observation, of_training),
        keep_learning=keep_learning,
        plans_with=plans_with,
        has_training=trained is not None,
        **plain(settings),
    )
    if needs_practice(name) and trained is None and not config.keep_learning:
        raise InvalidInput(
            f"{name} races with what it has learned: give the lane its training, or "
            "keep_learning=True"
        )
    return Lane(config, trained)


def race(
    lanes: Iterable[Lane | Training | Policy | str | AgentClass],
    *,
    steps: int = RACE_STEPS,
    seed: int = 0,
    on_step: Callable[[], object] | None = None,
    **walk: Unpack[Walk],
) -> Race:
    """Race one to six agents (paper §5), and record every step.

    Args:
        lanes: agents by name or class, trainings, or what `lane` or `policy` returns.
        steps: number of steps of each lane.
        seed: seed of all random generators.
        on_step: called after each step of a lane.
        walk: `gait`, `robot`, `simulator`, `divisions`, `grid_side_m`, `world`, `tolerance` and
            `reward`, as in `train`. What is left out is that of the first training in the race, or
            the default; world and tolerance are never those of a training.

    Raises:
        UnknownName, InvalidInput: if an argument is not valid; the message names what is.
        TableMismatch: if a training is of another walking problem.
        IllegalAction: if a policy returns no legal action; what it raises itself is raised.

    Examples:
        >>> import hexapods as hx
        >>> training = hx.train("q-learning", steps=100, seed=0, simulator="kinematic")
        >>> race = hx.race([training, "greedy"], steps=10)  # in the simulator of the training
        >>> for standing in race.standings:
        ...     print(standing.rank, standing.agent, round(standing.total_distance_m, 2))
        1 greedy 0.1
        2 q-learning -0.01
    """
    check_names("a race", walk, ("steps", "seed", *WALK))
    check_callable("on_step", on_step)
    if isinstance(lanes, str | Lane | Training | Policy) or not isinstance(lanes, Iterable):
        raise InvalidInput(f'lanes is a list, such as [training, "greedy"], not {lanes!r}')
    built = [entrant if isinstance(entrant, Lane) else lane(entrant) for entrant in lanes]
    config = config_of(built, {"steps": steps, "seed": seed, **walk})
    tables = [
        None if built_lane.training is None else built_lane.training.table for built_lane in built
    ]
    problem = problem_of(config)
    policies = {
        number: PolicyAgent(built_lane.policy, problem)
        for number, built_lane in enumerate(built)
        if built_lane.policy is not None
    }
    walkers = build_walkers(config, tables, agents=policies)
    recording: Sequence[LaneRecording] = ()
    for grown in record_race(walkers, config, time.perf_counter):
        recording = grown
        for agent in policies.values():
            if agent.error is not None:  # of the calling program, which is to know it
                raise agent.error
        if on_step is not None:
            on_step()
    return Race(config, recording, race_result(recording, config))


def config_of(lanes: Sequence[Lane], numbers_and_walk: Mapping[str, Any]) -> RaceConfig:
    """Return the config of a race; what is not given is of its first training, or the default.

    Raises:
        UnknownName, InvalidInput: if a value is not valid; the message names what is.
    """
    values = plain(numbers_and_walk)
    walk = {name: value for name, value in values.items() if name in WALK}
    numbers = {name: value for name, value in values.items() if name not in WALK}
    like = next((lane.training.config for lane in lanes if lane.training is not None), None)
    configs = tuple(lane.config for lane in lanes)
    config = check_savable(RaceConfig(**read_walk(walk, like), lanes=configs, **numbers))
    check_ends(config.world.disturbances, config.steps)
    return config


def load(path: str | os.PathLike[str]) -> Training | Race:
    """Load a training or a race that `save`, the dashboard or the command line has saved.

    Args:
        path: path of an `.npz` file.

    Raises:
        InvalidInput: if the file cannot be read.
        DamagedFile: if it holds neither, or was changed since it was written.

    Examples:
        >>> import hexapods as hx
        >>> race = hx.race(["greedy"], simulator="kinematic", steps=6)
        >>> hx.load(race.save("race.npz")).standings == race.standings
        True
    """
    file = path_of(path, "a file")
    try:
        data = file.read_bytes()
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            is_race = f"{CONFIG}.npy" in archive.namelist()
    except OSError as error:
        raise InvalidInput(f"{file} cannot be read: {error.strerror}") from error
    except zipfile.BadZipFile as error:
        raise DamagedFile(f"{file} is neither a training nor a race: {error}") from error
    return race_from_bytes(data, str(file)) if is_race else training_from_bytes(data, str(file))


def race_from_bytes(data: bytes, name: str) -> Race:
    """Decode the file of a race that `Race.save` has written.

    Args:
        data: content of the file.
        name: name of the file, for error messages.

    Raises:
        DamagedFile: if the file holds no race.
    """
    try:
        arrays = read_arrays(data)
        digest = str(arrays.pop(_DIGEST))
        if digest != digest_of(arrays):
            raise DamagedFile(f"{name} is damaged: its contents do not match its checksum")
        config = from_json(RaceConfig, json.loads(str(arrays.pop(CONFIG))))
        recording = race_recording(arrays)
        return Race(config, recording, race_result(recording, config))
    except DamagedFile:
        raise
    except Exception as error:  # zipfile and NumPy document no complete list of exceptions
        raise DamagedFile(f"{name} is not a race that was saved: {error}") from error


def _metres(value: float | None) -> str:
    return "" if value is None else f"{value:.2f} m"
