"""Tables and checkpoints from elsewhere: whole, finite, and fit to be gone on with."""

from collections.abc import Mapping
from typing import Any

import msgspec
import numpy as np

from app.archive.untrusted_input import Metres, Name, Share, Step
from app.domain.errors import DamagedFile, HexapodError
from app.runs import seeding, tables
from app.runs.config import CHANGEABLE, TrainingConfig, config_from_json
from app.runs.tables import Checkpoint


class TableMeta(msgspec.Struct):
    """Metadata of a table that is shown or that a resumed training relies on."""

    agent: Name
    step: Step
    rng: str
    episode_reward_m: Metres
    due_epsilon: Share | None
    greedy_distance_m: Metres | None
    changes: list[dict[str, Any]] = []


def checked_table(data: bytes, label: str) -> tuple[Checkpoint, TableMeta, TrainingConfig]:
    """The table in a file, what it says of itself, and the training that it is of.

    Args:
        data: all of the file.
        label: what to call it in messages.

    Raises:
        DamagedFile: if it is no table, does not hold together, or has a number out of range.
        TableMismatch: if it was learned for another problem than it says.
    """
    checkpoint = tables.from_bytes(data, label)
    config = _training(checkpoint.meta.get("config"), label)
    try:
        tables.check_fits(checkpoint, config, config.observation)
        meta = msgspec.convert(checkpoint.meta, TableMeta)
        if meta.agent != config.agent or meta.step > config.steps:
            raise ValueError("its step or agent is another than its training's")
        for change in meta.changes:
            check_change(change)
        seeding.load(np.random.default_rng(0), meta.rng)
        _check_agent(checkpoint)
    except HexapodError:
        raise
    except KeyError as error:
        raise DamagedFile(f"{label} does not say its {error}") from error
    except Exception as error:  # NumPy does not say all that strange arrays make it raise
        raise DamagedFile(f"{label} does not hold together: {error}") from error
    return checkpoint, meta, config


def check_change(change: Mapping[str, Any]) -> None:
    """Make sure that a change of rates or pace is one that could have been asked for.

    Raises:
        ValueError, InvalidInput: if it is none.
    """
    if unknown := set(change) - {"step", *CHANGEABLE}:
        raise ValueError(f"{', '.join(unknown)} cannot change while a training runs")
    msgspec.convert(change["step"], Step)
    for name in set(change) - {"step"}:
        CHANGEABLE[name].check(change[name])


def _training(shown: Any, label: str) -> TrainingConfig:
    if not isinstance(shown, Mapping):
        raise DamagedFile(f"{label} does not say what was trained")
    try:
        config = config_from_json(shown)
    except HexapodError as error:
        raise DamagedFile(f"{label} says of its training: {error}") from error
    except (KeyError, OverflowError, TypeError, ValueError, RecursionError) as error:
        raise DamagedFile(f"{label} does not say what was trained ({error})") from error
    if not isinstance(config, TrainingConfig):
        raise DamagedFile(f"{label} is of a race; give that of a training")
    return config


def _check_agent(checkpoint: Checkpoint) -> None:
    state = tables.agent_state(checkpoint)
    if "where" not in state:
        return
    tables.table_of(checkpoint)
    alpha, gamma, epsilon = state["rates"].tolist()
    CHANGEABLE["alpha"].check(alpha)
    CHANGEABLE["gamma"].check(gamma)
    # NaN as long as the schedule is in force.
    if not np.isnan(epsilon):
        CHANGEABLE["epsilon"].check(epsilon)
    if state["learned"].dtype.kind != "i" or state["learned"][0] < 0:
        raise ValueError("it has learned for less than no step")
