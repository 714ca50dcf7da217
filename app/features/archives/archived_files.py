"""Artifact files of a run in its archive: select them for export, validate them on import."""

import re
from collections.abc import Iterable, Iterator, Mapping
from functools import partial

import msgspec
import numpy as np
from numpy.typing import NDArray

from app.features.archives.archive import Member
from app.storage.artifact_file import chunks
from app.storage.database.store import RunStore
from app.storage.imported_tables import checked_table
from app.storage.run import CHECKPOINT, RESUMABLE, TABLE, Run
from app.storage.run_kind import added_kind
from app.storage.stored_races import RACE
from app.storage.stored_trainings import (
    PRACTICE,
    TRANSITIONS_PER_FILE,
    evaluations_file,
    transitions_file,
)
from app.storage.untrusted_input import (
    MAX_M,
    Large,
    Metres,
    PortableText,
    Seconds,
    Share,
    Step,
)
from hexapods.domain.errors import DamagedFile, HexapodError
from hexapods.domain.kinematics import legs_of
from hexapods.domain.robot_library import RobotLibrary
from hexapods.domain.simulator import Motion
from hexapods.domain.sums import ordered_sum
from hexapods.domain.types import Action, Cells
from hexapods.runs import tables
from hexapods.runs.config import RACE_STEPS, TrainingConfig, WalkingProblem
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.race_file import race_recording
from hexapods.runs.records import ActionValues, LaneStep
from hexapods.runs.results import TrainingResult
from hexapods.runs.stored_practice import practice_recording
from hexapods.runs.transition_log import MAX_LOGGED_STEPS, transitions

MAX_EVALUATION_FILES = 100
MAX_TRANSITION_FILES = MAX_LOGGED_STEPS // TRANSITIONS_PER_FILE
_EVALUATIONS = re.compile(r"evaluations-\d{4}\.npz", re.ASCII)
_TIME_TOLERANCE, _MIN_QUATERNION = 1.001, 0.5
"""For sums of rounded times, and for rounded unit quaternions."""
_TRANSITIONS = re.compile(r"transitions-\d{4}\.npz", re.ASCII)


def is_file_of(name: str, kind: str) -> bool:
    """Whether an archive of a run of this kind may have a file of this name."""
    if (added := added_kind(kind)) is not None:
        return added.is_member(name)
    if kind == "race":
        return name == RACE
    is_numbered = _EVALUATIONS.fullmatch(name) or _TRANSITIONS.fullmatch(name)
    return name in (TABLE, CHECKPOINT, PRACTICE) or is_numbered is not None


def members_of(store: RunStore, run: Run) -> dict[str, Member]:
    """Return the files of a run to export; each is verified now, and read when it is packed.

    Raises:
        DamagedFile: if one is damaged or missing.
    """
    names = [RACE]
    if (kind := added_kind(run.kind)) is not None:
        names = list(kind.file_names(run))
    if run.kind == "training":
        names = [TABLE, PRACTICE, *map(evaluations_file, range(MAX_EVALUATION_FILES))]
        names += map(transitions_file, range(MAX_TRANSITION_FILES))
        if run.state in RESUMABLE:
            names.append(CHECKPOINT)
    members = {}
    # A query for each of the 140 names that there could be would take most of the export's time.
    artifact_files = store.artifact_files(run.id)
    for name in filter(artifact_files.__contains__, names):
        file = store.open_artifact(run.id, name)
        if file is not None:
            members[name] = Member(file.size, partial(_chunks_of, store, run.id, name))
            file.close()
    return members


def _chunks_of(store: RunStore, run_id: str, name: str) -> Iterator[bytes]:
    file = store.open_artifact(run_id, name)
    if file is None:
        raise DamagedFile(f"{name} of run {run_id} is not there any more")
    return chunks(file)


def check_files(run: Run, files: Mapping[str, bytes], label: str, library: RobotLibrary) -> None:
    """Check that an imported walk's files are consistent with its config and can be displayed.

    Args:
        run: the imported run.
        files: contents of its files by name.
        label: name of the archive for error messages.
        library: has the archive's robots, and those that are stored here.

    Raises:
        DamagedFile: if a file is unexpected, malformed or inconsistent.
        TableMismatch: if a Q-table was learned for another problem.
    """
    for name, data in files.items():
        if not is_file_of(name, run.kind):
            raise DamagedFile(f"{label} has {name}, which no {run.kind} has")
        if name in (TABLE, CHECKPOINT):
            _check_table(run, name, data, f"{name} of {label}", library)
    try:
        if isinstance(run.config, RaceConfig):
            _check_race(run.config, files)
        else:
            _check_practice(run.config, files)
            _check_transitions(run.config, files)
    except Exception as error:  # NumPy documents no complete list of exceptions
        raise DamagedFile(f"{label} has a recording that cannot be shown: {error}") from error


def _check_table(run: Run, name: str, data: bytes, label: str, library: RobotLibrary) -> None:
    config = run.config
    if not isinstance(config, TrainingConfig):
        return
    checkpoint, meta, _ = checked_table(data, label, (config.agent,), library)
    try:
        tables.check_fits(checkpoint, config, config.observation)
        if meta.agent != config.agent:
            raise ValueError("another agent learned it")
        if meta.step > run.total:
            raise ValueError("it is of another step")
        if tables.table_arrays(tables.agent_state(checkpoint)) is not None:
            digest = tables.table_of(checkpoint).sha256()
            result = run.result if name == TABLE else None
            if isinstance(result, TrainingResult) and result.q_table_sha256 != digest:
                raise ValueError("its values are not those of the run's result")
    except HexapodError:
        raise
    except Exception as error:  # NumPy documents no complete list of exceptions
        raise DamagedFile(f"{label} is inconsistent: {error}") from error


def _check_race(config: RaceConfig, files: Mapping[str, bytes]) -> None:
    if RACE not in files:
        return
    lanes = race_recording(tables.read_arrays(files[RACE]))
    msgspec.convert([lane.failure for lane in lanes], list[PortableText | None])
    if [lane.agent for lane in lanes] != [lane.agent for lane in config.lanes]:
        raise ValueError("it has other lanes")
    for lane in lanes:
        if len(lane.steps) > config.steps:
            raise ValueError("it has more steps than the race")
        _check_poses(lane.rest_qpos[None], config)
        for step in lane.steps:
            _check_lane_step(step, config)
        msgspec.convert(ordered_sum(step.decision_s for step in lane.steps), Seconds)


def _check_lane_step(step: LaneStep, config: RaceConfig) -> None:
    msgspec.convert((step.reward_m, step.distance_m), tuple[Metres, Metres])
    msgspec.convert((step.decision_s, step.transitions), tuple[Seconds, Large])
    _check_motion(step.motion, config, 1)
    _check_choice(step.observation, step.action, step.action_values, config)
    for future in step.futures:
        _check_choice(step.observation, future.action, None, config)
        msgspec.convert((future.reward_m, future.return_m), tuple[Metres, Metres])


def _check_practice(config: TrainingConfig, files: Mapping[str, bytes]) -> None:
    if PRACTICE not in files:
        return
    names = sorted(name for name in files if _EVALUATIONS.fullmatch(name))
    if names != [evaluations_file(number) for number in range(len(names))]:
        raise ValueError("an evaluation is missing")
    evaluations = [tables.read_arrays(files[name]) for name in names]
    recording = practice_recording(tables.read_arrays(files[PRACTICE]), evaluations)
    _check_poses(recording.rest_qpos[None], config)
    numbers = [step.step for step in recording.steps]
    evaluated = [evaluation.step for evaluation in recording.evaluations]
    if numbers != sorted(set(numbers)) or evaluated != sorted(evaluated):
        raise ValueError("its steps are in no order")
    if not all(1 <= number <= config.steps for number in numbers):
        raise ValueError(f"its steps are not from 1 to {config.steps}")
    if not all(0 <= number <= config.steps for number in evaluated):
        raise ValueError(f"its evaluations are not of steps from 0 to {config.steps}")
    for step in recording.steps:
        msgspec.convert(step.episode, Step)
        msgspec.convert((step.reward_m, step.distance_m), tuple[Metres, Metres])
        msgspec.convert(step.epsilon, Share)
        _check_motion(step.motion, config, 1)
        _check_choice(step.observation, step.action, step.action_values, config)
    for evaluation in recording.evaluations:
        msgspec.convert(evaluation.epsilon, Share)
        msgspec.convert(evaluation.distance_m, Metres)
        _check_motion(evaluation.motion, config, RACE_STEPS)


def _check_transitions(config: WalkingProblem, files: Mapping[str, bytes]) -> None:
    names = sorted(name for name in files if _TRANSITIONS.fullmatch(name))
    if names != [transitions_file(number) for number in range(len(names))]:
        raise ValueError("some of its steps are missing")
    for number, name in enumerate(names):
        log = transitions(tables.read_arrays(files[name]))
        log.check(len(config.resolved_gait.groups), len(config.grid))
        if log.first != number * TRANSITIONS_PER_FILE or log.rewards_m.size == 0:
            raise ValueError("its steps do not follow each other")
        if log.rewards_m.size > TRANSITIONS_PER_FILE:
            raise ValueError("it has more steps than a file holds")


def _check_motion(motion: Motion | None, walk: WalkingProblem, steps: int) -> None:
    """Check the motion of at most so many steps."""
    if motion is None:
        return
    _check_poses(motion.qpos, walk)
    times = motion.time_s
    if times.shape != (len(motion.qpos),) or not np.isfinite(times).all():
        raise ValueError("its times are none")
    if (np.diff(times) <= 0).any() or times[0] <= 0:
        raise ValueError("its time does not go on")
    if times[-1] > steps * walk.robot.step_s * _TIME_TOLERANCE:
        raise ValueError("its steps take longer than the robot's")
    _check_effort(motion)


def _check_effort(motion: Motion) -> None:
    """Check torques, (frames, joints), and work, (frames,), which not every recording has."""
    torque, work = motion.torque_nm, motion.work_j
    if torque is not None:
        if torque.shape != motion.qpos[:, 7:].shape or torque.dtype != np.float16:
            raise ValueError("its torques are of another robot")
        if not np.isfinite(torque).all():
            raise ValueError("its torques are none")
    if work is not None:
        if work.shape != motion.time_s.shape or work.dtype.kind != "f":
            raise ValueError("its work is of other frames")
        if not np.isfinite(work).all() or (work < 0).any():
            raise ValueError("its work is none")


def _check_poses(qpos: NDArray[np.float32], walk: WalkingProblem) -> None:
    """Check poses, (frames, 7 + joints): position, unit quaternion, joint angles."""
    if qpos.shape[1:] != (legs_of(walk.robot).pose_size,) or not len(qpos):
        raise ValueError("its robot has other joints")
    # NaN is not below either.
    if qpos.dtype.kind != "f" or not (np.abs(qpos) < MAX_M).all():
        raise ValueError("its poses are none")
    if (np.linalg.norm(qpos[:, 3:7], axis=1) < _MIN_QUATERNION).any():
        raise ValueError("its torso has no rotation")


def _check_choice(
    observation: Cells, action: Action, action_values: ActionValues | None, walk: WalkingProblem
) -> None:
    groups, cells = len(walk.resolved_gait.groups), len(walk.grid)
    if len(observation) != groups or not _are_below(observation, cells):
        raise ValueError("what it saw is on no foot grid")
    if not _are_below([action.group], groups) or not _are_below([action.cell], cells):
        raise ValueError("what it did cannot be done")
    if action_values is not None:
        shapes = {np.shape(action_values.values), np.shape(action_values.visits)}
        if shapes != {(groups, cells)}:
            raise ValueError("what it knew is of another problem")
        # NaN marks impossible actions.
        if np.isinf(action_values.values).any() or np.isinf(action_values.visits).any():
            raise ValueError("what it knew is no number")


def _are_below(numbers: Iterable[object], limit: int) -> bool:
    return all(isinstance(number, int) and 0 <= number < limit for number in numbers)
