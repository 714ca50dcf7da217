"""Encode a run as the `run.json` of its archive, and parse it with strict validation."""

from collections.abc import Collection, Mapping, Sequence
from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta, Raw

from app.features.archives.archived_curve import CurveRows, read_curve
from app.jobs.submissions import check_training, check_walk
from app.storage.errors import Conflict
from app.storage.imported_tables import check_change, check_settings
from app.storage.run import (
    NOT_ENDED,
    Config,
    Run,
    world_of,
)
from app.storage.run_kind import added_kind, run_kinds
from app.storage.untrusted_input import (
    Count,
    Metres,
    Moment,
    Name,
    PortableText,
    UntrustedInput,
    check_json,
    check_moment,
)
from hexapods.domain.checks import check_format
from hexapods.domain.errors import DamagedFile, HexapodError, InvalidInput, UnknownName
from hexapods.domain.records import from_json, to_json
from hexapods.domain.robot import robot
from hexapods.domain.robot_library import RobotLibrary
from hexapods.domain.text import MAX_NOTES, MAX_TAG, check_name, check_notes, check_tags
from hexapods.experiments.config import MAX_WORKERS
from hexapods.runs.config import TrainingConfig
from hexapods.runs.lane import check_lane
from hexapods.runs.presses import MAX_PRESSES
from hexapods.runs.race_config import MAX_LANES, RaceConfig
from hexapods.runs.results import RaceResult
from hexapods.version import __version__

FORMAT = 2
"""Format of `run.json`."""
MAX_JSON_BYTES = 64_000_000
_MAX_PART_BYTES = 256_000  # of a config or a result
_MAX_RUN_BYTES = 8_000_000  # of all but the curve
_MAX_CHANGES = 10_000
"""More than `app.jobs.jobs.MAX_CHANGES`, which changes that wait for their acknowledgement at the
same time may pass by some."""

_Id = Annotated[str, Meta(pattern="^[0-9a-z]{1,32}$")]
_Press = Annotated[list[float], Meta(min_length=2, max_length=2)]
_Change = (
    float
    | int
    | str
    | bool
    | dict[Name, float | int | str | bool | list[int]]
    | Annotated[list[_Press], Meta(max_length=MAX_PRESSES)]
)
"""The step, a new pace, new values of settings, a disturbance, or presses."""


class _EndedRun(UntrustedInput, frozen=True):
    """Fields of a `Run` that has ended."""

    id: _Id
    kind: Name
    name: Name
    state: Literal["finished", "stopped", "failed", "interrupted"]
    config: Raw
    lane_training_ids: Annotated[list[_Id | None], Meta(max_length=MAX_LANES)]
    continued_from: _Id | None
    done: Count
    total: Count
    changes: Annotated[list[dict[Name, _Change]], Meta(max_length=_MAX_CHANGES)]
    greedy_distance_m: Metres | None  # null if it was not measured; JSON has no NaN
    result: Raw
    error: PortableText | None
    created_at: Moment
    started_at: Moment | None
    ended_at: Moment | None
    workers: Annotated[int, Meta(ge=1, le=MAX_WORKERS)] | None
    tags: tuple[Annotated[str, Meta(max_length=MAX_TAG)], ...]
    notes: Annotated[str, Meta(max_length=MAX_NOTES)]


class _File(UntrustedInput, frozen=True):
    format: int
    version: Name
    run: _EndedRun
    curve: Raw


class _Head(msgspec.Struct):
    format: int


class _OnlyCurve(msgspec.Struct):
    curve: Raw


def run_json(run: Run, curve: Sequence[Mapping[str, Any]]) -> bytes:
    """Encode an ended run and its learning curve as `run.json`.

    Raises:
        Conflict: if it has not ended.
        InvalidInput: if the output would be too long to be imported.
    """
    if run.state in NOT_ENDED:
        raise Conflict(f"{run.kind} {run.id} is {run.state}; stop it first", run.state)
    run_fields = {name: getattr(run, name) for name in _EndedRun.__struct_fields__}
    run_fields["config"] = to_json(run.config)
    run_fields["result"] = None if run.result is None else to_json(run.result)
    document = {"format": FORMAT, "version": __version__, "run": run_fields, "curve": list(curve)}
    data = msgspec.json.format(msgspec.json.encode(document), indent=1)
    if len(data) > MAX_JSON_BYTES:
        raise InvalidInput(f"{run.kind} {run.id} has too long a curve for an archive")
    return data


def read_run_json(
    data: bytes,
    label: str,
    kinds: Collection[str],
    agents: Collection[str],
    library: RobotLibrary,
) -> tuple[Run, CurveRows]:
    """Parse and validate `run.json`; return the run and its learning curve.

    Args:
        data: as written by `run_json`.
        label: name of the file for error messages.
        kinds: names of the kinds of runs that are not left out.
        agents: names of the registered agents.
        library: has the archive's robots, and those that are stored here.

    Raises:
        OtherFormat: if it is of another version.
        DamagedFile: if it is malformed or inconsistent.
        InvalidInput: if its kind, agent, robot or gait is not supported here.
    """
    try:
        if len(data) > MAX_JSON_BYTES:
            raise ValueError("it is too long")
        head = msgspec.json.decode(data, type=_Head)
        check_format(label, head.format, FORMAT)
        # The curve is the only member that may be long.
        curve_json = bytes(msgspec.json.decode(data, type=_OnlyCurve).curve)
        if len(data) - len(curve_json) > _MAX_RUN_BYTES:
            raise ValueError("it is too long")
        rest = data.replace(curve_json, b"[]", 1)
        check_json(rest)
        fields = msgspec.json.decode(rest, type=_File).run
        if fields.kind not in kinds:
            raise UnknownName("kind of run", fields.kind, kinds)
        run = _run(fields, agents, library)
        curve = read_curve(curve_json)
        _check(run, curve, library)
    except DamagedFile:
        raise
    except HexapodError as error:
        raise InvalidInput(f"{label} cannot be taken in: {error}") from error
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
        raise DamagedFile(f"{label} does not hold a run as it should: {error}") from error
    return run, curve


def _run(fields: _EndedRun, agents: Collection[str], library: RobotLibrary) -> Run:
    """Check the fields of a run, and return it."""
    kind, added = run_kinds()[fields.kind], added_kind(fields.kind)
    config = from_json(kind.config, _decode(fields.config, dict[str, Any]), context=library)
    if fields.done > fields.total:
        raise ValueError("its progress does not fit together")
    # First, as what follows imports the agents.
    _check_agents(config, agents)
    if isinstance(config, TrainingConfig):
        check_settings(config)
        check_training(config)
    elif added is not None:
        if added.checked_total(config) != fields.total:
            raise ValueError(f"its total is not that of its {added.counted}")
    else:
        check_walk(config)
    result = None
    if _decode(fields.result, Any) is not None:
        # No value is converted, and no other field is allowed.
        result = from_json(kind.result, bytes(fields.result), strict=True, extra="forbid")
    values = {name: getattr(fields, name) for name in fields.__struct_fields__}
    lanes = tuple(fields.lane_training_ids)
    values |= {
        "config": config,
        "result": result,
        "changes": tuple(fields.changes),
        "lane_training_ids": lanes,
    }
    return Run(**values)


def _decode(raw: Raw, kind: Any) -> Any:
    if len(bytes(raw)) > _MAX_PART_BYTES:
        raise ValueError("it is too long")
    return msgspec.json.decode(raw, type=kind)


def _check(run: Run, curve: CurveRows, library: RobotLibrary) -> None:
    """Check constraints on a run's fields beyond their types."""
    check_name(run.name)
    if check_tags(run.tags) != run.tags or check_notes(run.notes) != run.notes:
        raise ValueError("its tags or its notes are not as they are kept")
    for name in ("created_at", "started_at", "ended_at"):
        check_moment(name, getattr(run, name))
    for change in run.changes:
        if not isinstance(run.config, TrainingConfig):
            raise ValueError(f"it is no training but a {run.kind}, and has changes")
        check_change(change, run.config.agent)
    if isinstance(run.config, TrainingConfig):
        world_of(run).check(run.config.robot, run.config.simulator, run.config.steps)
    if not curve.is_ordered or (curve and run.kind != "training"):
        raise ValueError("its curve is none")
    _check_lanes(run, library)


def _check_lanes(run: Run, library: RobotLibrary) -> None:
    if not isinstance(run.config, RaceConfig):
        if run.lane_training_ids:
            raise ValueError(f"it is no race but a {run.kind}, and has lanes")
        return
    agents = [lane.agent for lane in run.config.lanes]
    if len(run.lane_training_ids) != len(agents):
        raise ValueError("its lanes do not fit together")
    for config, training_id in zip(run.config.lanes, run.lane_training_ids, strict=True):
        check_lane(config, has_training=training_id is not None)
    if not isinstance(run.result, RaceResult):
        return
    if [lane.agent for lane in run.result.lanes] != agents:
        raise ValueError("its result is of other lanes")
    for lane in run.result.lanes:
        if lane.trained_robot is not None:
            robot(lane.trained_robot, library)


def _check_agents(config: Config, agents: Collection[str]) -> None:
    """Check that all agents are registered: resuming a run would import, so execute, others."""
    if isinstance(config, RaceConfig):
        used: Collection[str] = [lane.agent for lane in config.lanes]
    else:
        used = config.agents if hasattr(config, "agents") else [config.agent]
    for name in used:
        if name not in agents:
            raise UnknownName("agent", name, agents)
