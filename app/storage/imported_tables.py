"""Validation of untrusted tables and checkpoints, so that a training can continue from them."""

from collections.abc import Collection, Mapping
from typing import Any

import msgspec
import numpy as np

from app.storage.untrusted_input import Metres, Name, Share, Step
from hexapods.agents import registry
from hexapods.agents.tabular import TabularAgent
from hexapods.domain.disturbance_documents import disturbance_from
from hexapods.domain.errors import DamagedFile, HexapodError, UnknownName
from hexapods.domain.records import from_json
from hexapods.domain.robot_library import LIBRARY, RobotLibrary
from hexapods.domain.settings import complete
from hexapods.domain.world import world
from hexapods.runs import seeding, tables
from hexapods.runs.config import TrainingConfig, agent_settings, changeable_settings
from hexapods.runs.presses import read_presses
from hexapods.runs.tables import Checkpoint


class TableMeta(msgspec.Struct):
    """Metadata of a table that is shown or that a resumed training relies on."""

    agent: Name
    step: Step
    rng: str
    episode_reward_m: Metres
    due_epsilon: Share | None
    greedy_distance_m: Metres | None
    next_action: tuple[int, int] | None = None
    next_epsilon: Share = 0.0
    changes: list[dict[str, Any]] = []
    disturbances: list[dict[str, Any]] = []
    measured_in: list[dict[str, Any]] = []
    fell_at_step: Step | None = None
    newest_epsilon: Share = 0.0


def checked_table(
    data: bytes, label: str, agents: Collection[str], library: RobotLibrary = LIBRARY
) -> tuple[Checkpoint, TableMeta, TrainingConfig]:
    """Parse and validate a table file; return checkpoint, metadata and config of its training.

    Args:
        data: content of the file.
        label: name of the file for error messages.
        agents: names of the registered agents; no other agent is imported.
        library: where the robot of its training is found by its id.

    Raises:
        UnknownName: if its agent is not registered.
        DamagedFile: if it is no table, is inconsistent, or has a number out of range.
        TableMismatch: if its metadata and its config are of different walking problems.
    """
    checkpoint = tables.from_bytes(data, label)
    config = _training(checkpoint.meta.get("config"), label, library)
    if config.agent not in agents:
        raise UnknownName("agent", config.agent, agents)
    try:
        check_settings(config)
        tables.check_fits(checkpoint, config, config.observation)
        meta = msgspec.convert(checkpoint.meta, TableMeta)
        if meta.agent != config.agent or meta.step > config.steps:
            raise ValueError("its step or agent is another than its training's")
        group, cell = meta.next_action or (0, 0)
        if not (0 <= group < len(config.resolved_gait.groups) and 0 <= cell < len(config.grid)):
            raise ValueError("its next action is not on the grid")
        for change in meta.changes:
            check_change(change, config.agent)
        for happened in (meta.disturbances, meta.measured_in):
            world(happened).check(config.robot, config.simulator, config.steps)
        seeding.load(np.random.default_rng(0), meta.rng)
        _check_state(checkpoint, config.agent, label)
    except HexapodError:
        raise
    except KeyError as error:
        raise DamagedFile(f"{label} does not say its {error}") from error
    except Exception as error:  # NumPy documents no complete list of exceptions
        raise DamagedFile(f"{label} is inconsistent: {error}") from error
    return checkpoint, meta, config


def check_settings(config: TrainingConfig) -> None:
    """Check that the settings of a training are valid; its agent must be registered.

    Raises:
        UnknownName, InvalidInput: if they are not.
    """
    complete(agent_settings(config.agent), config.settings, config.agent)


def check_change(change: Mapping[str, Any], agent: str) -> None:
    """Check that a recorded change of settings or pace, or a disturbance, is valid.

    Args:
        change: the `step` of the change, and a new `pace`, new `settings`, a `disturbance`,
            or `presses`.
        agent: name of a registered agent.

    Raises:
        KeyError, TypeError, ValueError: if it is not.
    """
    valid = dict(changeable_settings(agent))
    pace = valid.pop("pace")
    settings = msgspec.convert(change.get("settings", {}), dict[str, Any])
    unknown = {*change} - {"step", "pace", "disturbance", "settings", "presses"} | {*settings} - {
        *valid
    }
    if unknown:
        raise ValueError(f"{', '.join(unknown)} cannot change while a training runs")
    msgspec.convert(change["step"], Step)
    if "disturbance" in change:
        disturbance_from(change["disturbance"])
    if "pace" in change:
        pace.check(change["pace"])
    if "presses" in change:
        read_presses(change["presses"], agent)
    for name, value in settings.items():
        valid[name].check(value)


def _training(config_data: Any, label: str, library: RobotLibrary) -> TrainingConfig:
    if not isinstance(config_data, Mapping):
        raise DamagedFile(f"{label} does not say what was trained")
    try:
        if "lanes" in config_data:
            raise DamagedFile(f"{label} is of a race; give that of a training")
        return from_json(TrainingConfig, config_data, context=library)
    except DamagedFile:
        raise
    except HexapodError as error:
        raise DamagedFile(f"{label} says of its training: {error}") from error
    except (KeyError, OverflowError, TypeError, ValueError, RecursionError) as error:
        raise DamagedFile(f"{label} does not say what was trained ({error})") from error


def _check_state(checkpoint: Checkpoint, agent: str, label: str) -> None:
    state, agent_class = tables.agent_state(checkpoint), registry.find(agent)
    if tables.table_arrays(state) is not None:
        tables.table_of(checkpoint)
    elif isinstance(agent_class, type) and issubclass(agent_class, TabularAgent):
        raise DamagedFile(f"{label} lacks the table that {agent} keeps")
    check_state = getattr(agent_class, "check_state", None)
    if check_state is not None:
        check_state(state)
