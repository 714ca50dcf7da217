"""Checkpoints: all that is needed to resume a training, as one `.npz` file.

It holds values, visit counts, rates, the state of the learning generator, the complete state of
the simulator, counters and the config. No pickle and no compression, so that loading a file runs
no code and takes no more memory than its size (no zip bombs).
"""

import hashlib
import io
import json
import zipfile
from collections.abc import Callable, Container, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from hexapods.agents.landing_table import (
    LANDING_ARRAYS,
    LandingRows,
    check_landing_arrays,
    check_landings,
)
from hexapods.agents.protocol import Agent, Tabular
from hexapods.agents.q_table import check_arrays, check_size
from hexapods.agents.table_rows import TABLE_ARRAYS, VALUES_AT_ONCE, Chunk, TableRows
from hexapods.domain.checks import check_format
from hexapods.domain.disturbance_documents import as_mapping
from hexapods.domain.errors import DamagedFile, InvalidInput, TableMismatch
from hexapods.domain.grid import FootGrid
from hexapods.domain.records import to_json
from hexapods.domain.short_repr import short_repr
from hexapods.domain.world import world
from hexapods.runs import seeding
from hexapods.runs.config import TrainingConfig, WalkingProblem
from hexapods.runs.recording import Arrays
from hexapods.runs.training import Learner

FORMAT = 2
"""Format of the metadata."""
MEDIA_TYPE = "application/x-npz"
_MAX_ARRAYS = 10_000
"""Arrays of a file: more than any has that this product writes."""
_AGENT, _STATE = "agent.", "state."


@dataclass(frozen=True)
class Checkpoint:
    """State of a training between two steps.

    Attributes:
        meta: in plain types: `gait`, `azimuths_deg`, `pairs`, `legs`, `divisions`, `grid_side_m`,
            `observation`, `agent`, `step`, `config`, and fields that the writer adds.
        arrays: the agent's state under the prefix `agent.`, the simulator's under `state.`.
    """

    __repr__ = short_repr

    meta: Mapping[str, Any]
    arrays: Arrays

    def part(self, prefix: str) -> Arrays:
        """Return the arrays whose names have a prefix, by their names without it."""
        return {k.removeprefix(prefix): v for k, v in self.arrays.items() if k.startswith(prefix)}


def snapshot(learner: Learner, config: TrainingConfig, **more: Any) -> Checkpoint:
    """Create a checkpoint of a learner; `more` is added to its metadata."""
    walker, gait = learner.walker, config.resolved_gait
    agent = {_AGENT + k: v for k, v in walker.agent.state().items()}
    state = {_STATE + k: v for k, v in walker.simulator.dump(walker.state).items()}
    meta = {
        "format": FORMAT,
        "agent": config.agent,
        "gait": gait.name,
        "azimuths_deg": gait.azimuths_deg,
        "pairs": gait.groups,
        "legs": len(config.robot.legs),
        "divisions": config.divisions,
        "grid_side_m": config.grid_side_m,
        "observation": config.observation,
        "step": learner.step,
        "episode_reward_m": learner.episode_reward_m,
        "greedy_distance_m": learner.greedy_distance_m,
        "due_epsilon": learner.due_epsilon,
        **_next_step(learner),
        "rng": seeding.dump(learner.rng),
        "config": to_json(config),
        "disturbances": [as_mapping(disturbance) for disturbance in learner.world.disturbances],
        "fell_at_step": learner.fell_at_step,
        "newest_epsilon": learner.newest_epsilon,
        "measured_in": [
            as_mapping(disturbance) for disturbance in learner.measured_in.disturbances
        ],
        **more,
    }
    return Checkpoint(json.loads(json.dumps(meta)), {**agent, **state})


def _next_step(learner: Learner) -> dict[str, Any]:
    if learner.next_action is None:
        return {}
    return {"next_action": learner.next_action, "next_epsilon": learner.next_epsilon}


def restore(learner: Learner, checkpoint: Checkpoint) -> None:
    """Restore the complete state of a new learner of the same config from a checkpoint.

    Raises:
        IllegalAction: if the stored next action is not legal in the restored state.
    """
    walker, meta = learner.walker, checkpoint.meta
    walker.simulator.world = world(meta["disturbances"])
    learner.measured_in = world(meta["measured_in"])
    learner.fell_at_step = meta["fell_at_step"]
    learner.newest_epsilon = meta["newest_epsilon"]
    walker.agent.load(checkpoint.part(_AGENT))
    walker.set_state(walker.simulator.load(checkpoint.part(_STATE)))
    seeding.load(learner.rng, meta["rng"])
    learner.step, learner.episode_reward_m = meta["step"], meta["episode_reward_m"]
    learner.greedy_distance_m = meta["greedy_distance_m"]
    learner.due_epsilon = meta["due_epsilon"]
    chosen = meta.get("next_action")
    if chosen is not None:
        learner.next_action = walker.legal_action(chosen)
        learner.next_epsilon = meta["next_epsilon"]


def continue_from(agent: Agent, rng: np.random.Generator, checkpoint: Checkpoint) -> None:
    """Initialise a new agent and its generator from a checkpoint: what was learned, and no more.

    Rates come from its own config, the ε schedule restarts, and the robot starts from rest.

    Raises:
        TableMismatch: if the checkpoint is of another agent.
        DamagedFile: if the generator's state is missing or invalid.
    """
    if isinstance(agent, Tabular):
        # Without a copy: it is as large as the table, and an agent copies what it keeps.
        _load(agent, checkpoint, agent.continue_from, agent_state(checkpoint))
    else:
        load_agent(agent, checkpoint, getattr(agent, "continue_from", None))
    try:
        seeding.load(rng, checkpoint.meta["rng"])
    except (KeyError, TypeError, ValueError) as error:
        raise DamagedFile("the table does not hold its generator's state") from error


def agent_state(checkpoint: Checkpoint) -> Arrays:
    """Return the agent's state in a checkpoint."""
    return checkpoint.part(_AGENT)


def load_agent(
    agent: Agent, checkpoint: Checkpoint, load: Callable[[Arrays], None] | None = None
) -> None:
    """Load a copy of the agent's state in a checkpoint into an agent of the same class.

    Args:
        agent: the agent.
        checkpoint: the checkpoint.
        load: its method that takes the state; `load` by default.

    Raises:
        TableMismatch: if the checkpoint is of another agent.
    """
    # A copy, which the agent may change: others race with the same checkpoint.
    state = {name: array.copy() for name, array in agent_state(checkpoint).items()}
    _load(agent, checkpoint, load or agent.load, state)


def _load(
    agent: Agent, checkpoint: Checkpoint, load: Callable[[Arrays], None], state: Arrays
) -> None:
    try:
        load(state)
    except InvalidInput:
        raise
    except (IndexError, KeyError, TypeError, ValueError) as error:
        raise TableMismatch(
            f"{type(agent).__name__} cannot load what {checkpoint.meta['agent']} has learned; "
            "choose a table of the same agent"
        ) from error


def table_arrays(names: Container[str]) -> tuple[str, str, str] | None:
    """Return the names of the arrays of an agent's table in a state; None if it keeps no table."""
    return next((arrays for arrays in (TABLE_ARRAYS, LANDING_ARRAYS) if arrays[0] in names), None)


def table_of(checkpoint: Checkpoint) -> TableRows | LandingRows:
    """Return the table in a checkpoint: of states and actions, or of landings.

    Raises:
        TableMismatch: if its agent has no table, or the arrays do not fit the metadata.
        InvalidInput: if it is too large.
    """
    state, meta = agent_state(checkpoint), checkpoint.meta
    names = table_arrays(state)
    if names is None:
        raise TableMismatch(f"the agent {meta['agent']} keeps no Q-table")
    shape = len(meta["pairs"]), len(FootGrid(meta["grid_side_m"], meta["divisions"]))

    def parts() -> Iterator[Chunk]:
        for first in range(0, len(state[names[0]]), VALUES_AT_ONCE):
            where, q, n = (state[name][first : first + VALUES_AT_ONCE] for name in names)
            yield where, q, n

    if names == LANDING_ARRAYS:
        check_landings(*shape)
        check_landing_arrays(state, *shape)
        return LandingRows(*shape, parts)
    check_size(*shape)
    check_arrays(state, *shape)
    return TableRows(*shape, parts)


def check_fits(
    checkpoint: Checkpoint, walk: WalkingProblem, observation: str | None = None
) -> None:
    """Check that a table was learned for this walking problem; robot and simulator may differ.

    Args:
        checkpoint: the table.
        walk: the walking problem.
        observation: required observation mode; None for any.

    Raises:
        TableMismatch: at the first difference; the message names it.
    """
    gait, meta = walk.resolved_gait, checkpoint.meta
    wanted: dict[str, Any] = {
        "legs": len(walk.robot.legs),
        "gait": gait.name,
        "pairs": [list(group) for group in gait.groups],
        "azimuths_deg": list(gait.azimuths_deg),
        "divisions": walk.divisions,
        "grid_side_m": walk.grid_side_m,
    }
    if observation is not None:
        wanted["observation"] = observation
    for name, value in wanted.items():
        if meta[name] != value:
            raise TableMismatch(
                f"the table was learned for {name} {_as_text(meta[name])}, this run has "
                f"{_as_text(value)}; choose a table of the same gait, legs, divisions, grid and "
                "observation, or train one"
            )


def _as_text(value: object) -> str:
    return value if isinstance(value, str) else json.dumps(value)


def to_bytes(checkpoint: Checkpoint) -> bytes:
    """Encode a checkpoint as an `.npz` file with a SHA-256 digest."""
    meta = json.dumps(dict(checkpoint.meta))
    members = {**checkpoint.arrays, "meta": np.array(meta)}
    buffer = io.BytesIO()
    np.savez(buffer, **members, digest=np.array(digest_of(members)))  # type: ignore[arg-type]
    return buffer.getvalue()


def from_bytes(data: bytes, name: str) -> Checkpoint:
    """Decode the checkpoint in a file, and verify its digest.

    Args:
        data: content of the file.
        name: name of the file for error messages.

    Raises:
        OtherFormat: if it is of another version.
        DamagedFile: if it is no table, was changed since it was written, or is compressed.
    """
    try:
        members = read_arrays(data)
        digest = str(members.pop("digest"))
        is_intact = digest == digest_of(members)
        meta = json.loads(str(members.pop("meta")))
        version = meta["format"]
    except Exception as error:  # zipfile and NumPy document no complete list of exceptions
        raise DamagedFile(f"{name} is not a Q-table of this product: {error}") from error
    if not is_intact:
        raise DamagedFile(f"{name} is damaged: its contents do not match its checksum")
    check_format(name, version, FORMAT)
    return Checkpoint(meta, members)


def read_arrays(data: bytes) -> Arrays:
    """Decode the arrays of an `.npz` file; rejects compressed and overlapping members.

    Raises:
        ValueError: if it could unpack to more than its size. zipfile and NumPy raise other
            exceptions for a damaged file.
    """
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        members = archive.infolist()
    if len(members) > _MAX_ARRAYS:
        raise ValueError(f"it has {len(members):,} arrays; a file has at most {_MAX_ARRAYS:,}")
    if any(member.compress_type != zipfile.ZIP_STORED for member in members):
        raise ValueError("its members are compressed; write it with numpy.savez")
    if sum(member.file_size for member in members) > len(data):
        raise ValueError("its members claim to be larger than the file")
    with np.load(io.BytesIO(data), allow_pickle=False) as file:
        return {name: file[name] for name in file.files}


def digest_of(members: Arrays) -> str:
    """Return the SHA-256 of the arrays of a file, with their names, types and shapes."""
    digest = hashlib.sha256()
    for key in sorted(members):
        array = np.ascontiguousarray(members[key])
        digest.update(f"{key} {array.dtype.str} {array.shape}".encode())
        # Hash a view where possible: `tobytes` would copy a large table.
        digest.update(array.tobytes() if array.dtype.kind == "U" else array.data)
    return digest.hexdigest()
