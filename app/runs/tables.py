"""Checkpoints: all that is needed to continue learning, as one `.npz` file.

Values, visits, rates, the learning generator's state, the whole state of the simulator, counters,
and what the table was learned for. No pickle, and nothing compressed, so that a file unpacks to
no more than its own size.
"""

import hashlib
import io
import json
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.agents.protocol import Agent, Tabular
from app.agents.q_table import check_arrays, check_size
from app.agents.table_rows import VALUES_AT_ONCE, Part, TableRows
from app.domain.errors import DamagedFile, TableMismatch
from app.domain.grid import FootGrid
from app.runs import seeding
from app.runs.config import TrainingConfig, WalkingProblem, as_json
from app.runs.recording import Arrays
from app.runs.training import Learner

FORMAT = 1
MEDIA_TYPE = "application/x-npz"
_AGENT, _STATE = "agent.", "state."


@dataclass(frozen=True)
class Checkpoint:
    """A training at one moment between two steps.

    Attributes:
        meta: in plain types: `gait`, `azimuths_deg`, `pairs`, `legs`, `divisions`, `grid_side_m`,
            `observation`, `agent`, `step`, `config`, and what else the writer adds.
        arrays: `agent.…` is the agent's state, `state.…` the simulator's.
    """

    meta: Mapping[str, Any]
    arrays: Arrays

    def part(self, prefix: str) -> Arrays:
        """The arrays under a prefix, without it."""
        return {k.removeprefix(prefix): v for k, v in self.arrays.items() if k.startswith(prefix)}


def snapshot(learner: Learner, config: TrainingConfig, **more: Any) -> Checkpoint:
    """The learner as it is now; `more` goes into the meta data."""
    walker, gait = learner.walker, config.resolved_gait
    agent = {_AGENT + k: v for k, v in walker.agent.state().items()}
    state = {_STATE + k: v for k, v in walker.simulator.dump(walker.state).items()}
    meta = {
        "format": FORMAT,
        "agent": config.agent,
        "gait": gait.name,
        "azimuths_deg": gait.azimuths_deg,
        "pairs": gait.pairs,
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
        "config": as_json(config),
        **more,
    }
    return Checkpoint(json.loads(json.dumps(meta)), {**agent, **state})


def _next_step(learner: Learner) -> dict[str, Any]:
    if learner.next_action is None:
        return {}
    return {"next_action": learner.next_action, "next_epsilon": learner.next_epsilon}


def restore(learner: Learner, checkpoint: Checkpoint) -> None:
    """Put a fresh learner of the same config exactly where the snapshot was taken.

    Raises:
        IllegalAction: if the action that comes next is not legal there.
    """
    walker, meta = learner.walker, checkpoint.meta
    walker.agent.load(checkpoint.part(_AGENT))
    walker.place(walker.simulator.load(checkpoint.part(_STATE)))
    seeding.load(learner.rng, meta["rng"])
    learner.step, learner.episode_reward_m = meta["step"], meta["episode_reward_m"]
    learner.greedy_distance_m = meta["greedy_distance_m"]
    learner.due_epsilon = meta["due_epsilon"]
    chosen = meta.get("next_action")
    if chosen is not None:
        learner.next_action = walker.legal_action(chosen)
        learner.next_epsilon = meta["next_epsilon"]


def continue_from(learner: Learner, checkpoint: Checkpoint) -> None:
    """Let a fresh learner go on with what was learned: values, visits and the generator.

    Its rates are its own, ε restarts, and the robot starts from rest.

    Raises:
        TableMismatch: if another agent learned it.
        DamagedFile: if the generator's state is none.
    """
    agent = learner.walker.agent
    if isinstance(agent, Tabular):
        agent.continue_from(agent_state(checkpoint))
    else:
        load_agent(agent, checkpoint)
    try:
        seeding.load(learner.rng, checkpoint.meta["rng"])
    except (KeyError, TypeError, ValueError) as error:
        raise DamagedFile("the table does not hold its generator's state") from error


def agent_state(checkpoint: Checkpoint) -> Arrays:
    """Return the agent's state."""
    return checkpoint.part(_AGENT)


def load_agent(agent: Agent, checkpoint: Checkpoint) -> None:
    """Let an agent go on from what one of its kind had learned.

    Raises:
        TableMismatch: if another agent learned it.
    """
    try:
        agent.load(agent_state(checkpoint))
    except (IndexError, KeyError, TypeError, ValueError) as error:
        raise TableMismatch(
            f"{type(agent).__name__} cannot load what {checkpoint.meta['agent']} has learned; "
            "choose a table of the same agent"
        ) from error


def table_of(checkpoint: Checkpoint) -> TableRows:
    """The Q-table inside.

    Raises:
        TableMismatch: if the agent that learned keeps none, or it is of another problem.
        InvalidInput: if it is too large.
    """
    state, meta = agent_state(checkpoint), checkpoint.meta
    if "where" not in state:
        raise TableMismatch(f"the agent {meta['agent']} keeps no Q-table")
    pairs, cells = len(meta["pairs"]), len(FootGrid(meta["grid_side_m"], meta["divisions"]))
    check_size(pairs, cells)
    check_arrays(state, pairs, cells)

    def parts() -> Iterator[Part]:
        for first in range(0, len(state["where"]), VALUES_AT_ONCE):
            where, q, n = (
                state[name][first : first + VALUES_AT_ONCE] for name in ("where", "q", "n")
            )
            yield where, q, n

    return TableRows(pairs, cells, parts)


def check_fits(
    checkpoint: Checkpoint, walk: WalkingProblem, observation: str | None = None
) -> None:
    """Make sure that a table was learned for this walking problem; its robot may differ.

    Raises:
        TableMismatch: naming what differs, and what would fit.
    """
    gait, meta = walk.resolved_gait, checkpoint.meta
    wanted: dict[str, Any] = {
        "legs": len(walk.robot.legs),
        "gait": gait.name,
        "pairs": [list(pair) for pair in gait.pairs],
        "azimuths_deg": list(gait.azimuths_deg),
        "divisions": walk.divisions,
        "grid_side_m": walk.grid_side_m,
    }
    if observation is not None:
        wanted["observation"] = observation
    for name, value in wanted.items():
        if meta[name] != value:
            raise TableMismatch(
                f"the table was learned for {name} {_said(meta[name])}, this run has "
                f"{_said(value)}; choose a table of the same gait, legs, divisions, grid and "
                "observation, or train one"
            )


def _said(value: object) -> str:
    return value if isinstance(value, str) else json.dumps(value)


def to_bytes(checkpoint: Checkpoint) -> bytes:
    """The file."""
    meta = json.dumps(dict(checkpoint.meta))
    members = {**checkpoint.arrays, "meta": np.array(meta)}
    buffer = io.BytesIO()
    np.savez(buffer, **members, digest=np.array(_digest(members)))  # type: ignore[arg-type]
    return buffer.getvalue()


def from_bytes(data: bytes, name: str) -> Checkpoint:
    """The checkpoint in a file.

    Args:
        data: all of the file.
        name: of the file, for the message.

    Raises:
        DamagedFile: if it is no table, was changed since it was written, or could unpack to more
            than it is.
    """
    try:
        members = read_arrays(data)
        digest = str(members.pop("digest"))
        whole = digest == _digest(members)
        meta = json.loads(str(members.pop("meta")))
        known = meta["format"] == FORMAT
    except Exception as error:  # zipfile and NumPy do not say all that damage makes them raise
        raise DamagedFile(f"{name} is not a Q-table of this product: {error}") from error
    if not whole:
        raise DamagedFile(f"{name} is damaged: its contents do not match its checksum")
    if not known:
        raise DamagedFile(f"{name} has format {meta['format']}; this version reads {FORMAT}")
    return Checkpoint(meta, members)


def read_arrays(data: bytes) -> Arrays:
    """The arrays of an `.npz` file, which cannot unpack to more than it is.

    Raises:
        ValueError: if it could; and whatever zipfile and NumPy make of damage.
    """
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        members = archive.infolist()
    if any(member.compress_type != zipfile.ZIP_STORED for member in members):
        raise ValueError("its members are compressed; write it with numpy.savez")
    if sum(member.file_size for member in members) > len(data):
        raise ValueError("its members claim to be larger than the file")
    with np.load(io.BytesIO(data), allow_pickle=False) as file:
        return {name: file[name] for name in file.files}


def _digest(members: Arrays) -> str:
    digest = hashlib.sha256()
    for key in sorted(members):
        array = np.ascontiguousarray(members[key])
        digest.update(f"{key} {array.dtype.str} {array.shape}".encode())
        # A view where there can be one: a large table is not copied to be hashed.
        digest.update(array.tobytes() if array.dtype.kind == "U" else array.data)
    return digest.hexdigest()
