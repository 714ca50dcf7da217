"""Tables from elsewhere: checked, and then trainings like any other."""

from collections.abc import Collection, Mapping
from datetime import UTC, datetime
from typing import Any

from app.domain.errors import DamagedFile, HexapodError, UnknownName
from app.runs import tables
from app.runs.config import TrainingConfig, config_from_json
from app.services.entries import check_walk
from app.services.jobs import Jobs
from app.services.store import Run


def adopt(jobs: Jobs, data: bytes, agents: Collection[str], name: str | None = None) -> Run:
    """Keep a table as a finished training.

    Args:
        jobs: where the training is to be found afterwards.
        data: the table's `.npz` file.
        agents: the names that are known here.
        name: of the training.

    Raises:
        DamagedFile: if it is no table, or does not hold together.
        InvalidInput: if it was learned by an agent, or on a robot, that cannot be here.
    """
    checkpoint = tables.from_bytes(data, "the file")
    config = _training(checkpoint.meta.get("config"))
    check_walk(config)
    if config.agent not in agents:
        raise UnknownName("agent", config.agent, agents)
    try:
        tables.check_fits(checkpoint, config, config.observation)
        step = checkpoint.meta["step"]
        is_whole = isinstance(step, int) and checkpoint.meta["agent"] == config.agent
    except KeyError as error:
        raise DamagedFile(f"the file does not say its {error}") from error
    if not is_whole:
        raise DamagedFile("the file does not hold together: its step or agent is another")
    greedy = checkpoint.meta.get("greedy_distance_m")
    digest = None
    if "where" in tables.agent_state(checkpoint):
        digest = tables.table_of(checkpoint).sha256()
    greedy = checkpoint.meta.get("greedy_distance_m")
    run = Run(
        id=jobs.new_id(),
        kind="training",
        name=name or f"Imported, {step:,} steps, {config.resolved_gait.name}",
        state="finished",
        config=config,
        done=step,
        total=step,
        greedy_distance_m=greedy,
        result={"distance_m": None, "greedy_distance_m": greedy, "q_table_sha256": digest},
        ended_at=datetime.now(UTC),
    )
    jobs.keep(run, data)
    return run


def _training(shown: Any) -> TrainingConfig:
    """The training that a file says it is of.

    Raises:
        DamagedFile: if it says none.
    """
    if not isinstance(shown, Mapping):
        raise DamagedFile("the file does not say what was trained")
    try:
        config = config_from_json(shown)
    except HexapodError as error:
        raise DamagedFile(f"the file says of its training: {error}") from error
    except (KeyError, OverflowError, TypeError, ValueError) as error:
        raise DamagedFile(f"the file does not say what was trained ({error})") from error
    if not isinstance(config, TrainingConfig):
        raise DamagedFile("the file is of a race; give that of a training")
    return config
