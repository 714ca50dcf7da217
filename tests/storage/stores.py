"""Helpers for tests: stores on every database, and sample runs, configs and trials."""

from collections.abc import Iterator
from contextlib import closing, contextmanager
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, TypeVar

from app.active_features import migrate_tables
from app.installed_features import load
from app.settings import Settings
from app.storage.database.engine import Database, sqlite_engine
from app.storage.database.opening import DATABASE_FILE, open_store
from app.storage.database.sqlite_file import create_file
from app.storage.database.store import RunStore
from app.storage.run import Run
from hexapods.domain.gait import GaitSpec
from hexapods.domain.robot import robot
from hexapods.domain.settings import SettingValues
from hexapods.experiments.config import ExperimentConfig
from hexapods.runs.config import TrainingConfig, training_config
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import RaceConfig
from tests.postgresql import PostgresServer

StoreT = TypeVar("StoreT", bound=RunStore)
BACKENDS = ["sqlite", "postgresql"]
PLAIN = training_config(gait="left-right-origin")
ODD = TrainingConfig(
    gait=GaitSpec(right_leg=1, left_leg=4, pairs=((1, 4), (2, 6), (3, 5))),
    robot=robot({"preset": "slippery", "n_legs": 6, "mount_radius_m": 0.12, "femur_m": 0.09}),
    simulator="kinematic",
    seed=2**80,
    pace=2.5,
    agent="my.module:Agent",
    settings=SettingValues({"width": 3, "mode": "wide"}),
)
RACE = RaceConfig(
    gait="front-back-vertical",
    lanes=(LaneConfig(agent="q-learning", observation="commanded"), LaneConfig(agent="greedy")),
)


def training(run_id: str, **fields: Any) -> Run:
    """Create a training, queued by default."""
    fields = {"name": f"training {run_id}", "config": PLAIN, "total": 500, **fields}
    return Run(id=run_id, kind="training", **fields)


def race(run_id: str, **fields: Any) -> Run:
    """Create a race, queued by default."""
    fields = {"name": f"race {run_id}", "config": RACE, "total": 100, **fields}
    return Run(id=run_id, kind="race", lane_training_ids=("abc", None), **fields)


SWEEP = ExperimentConfig(
    experiment="sweep",
    seeds=3,
    seed=2**80,
    agents=("q-learning", "my.module:Agent"),
    gaits=("left-right-origin", ODD.gait),
    observations=("commanded",),
    robots=(robot("stiff"), ODD.robot),
    simulator="kinematic",
    settings=SettingValues({"alpha": (0.1, 0.3)}),
    divisions=(2, 3),
)
TRIALS: list[dict[str, Any]] = [
    {
        "key": "left-right-origin/commanded/stiff/greedy#0",
        "result": {
            "distances_m": [0.49666, -0.25],
            "finished_distance_m": None,
            "elapsed_s": 1.5,
            "transitions": 600,
            "wall": [{"agent": "greedy", "rank": 1}],
            "failure": None,
        },
        "set_aside": None,
        "compute_s": 0.0125,
    },
    {
        "key": "left-right-origin/commanded/stiff/q-learning/500/α=0.1#12",
        "result": None,
        "set_aside": "it ended its worker's process 3 times",
        "compute_s": 0.0,
    },
]


def experiment(run_id: str, **fields: Any) -> Run:
    """Create an experiment, queued by default."""
    fields = {"name": f"experiment {run_id}", "config": SWEEP, "total": 100, **fields}
    return Run(id=run_id, kind="experiment", **fields)


@contextmanager
def database_url(backend: str, server: PostgresServer | None) -> Iterator[str | None]:
    """Create a database, and yield the setting for its URL; None for SQLite."""
    if backend == "sqlite":
        yield None
        return
    assert server is not None
    with server.database() as url:
        yield url


@contextmanager
def opened(folder: Path, url: str | None) -> Iterator[RunStore]:
    """Open the store of a server with this data folder and database URL, and features' tables."""
    with open_store(Settings(data=folder, database_url=url)) as store:
        migrate_tables(load().classes, store.database)
        yield store


@contextmanager
def temporary_store() -> Iterator[RunStore]:
    """Open an empty SQLite store in a temporary folder, which is deleted at the end."""
    with TemporaryDirectory() as folder:
        copy_new_database(Path(folder))
        with opened(Path(folder), None) as store:
            yield store


def copy_new_database(folder: Path) -> None:
    """Make a SQLite database that no server has owned, with the tables of core and features.

    Migrations take longer than most tests.
    """
    (folder / DATABASE_FILE).write_bytes(_new_database())


@cache
def _new_database() -> bytes:
    with TemporaryDirectory() as folder:
        path = Path(folder) / DATABASE_FILE
        create_file(path, lambda: False)
        with closing(Database(sqlite_engine(path))) as database:
            migrate_tables(load().classes, database)
        return path.read_bytes()


def of_type(kind: type[StoreT], store: RunStore) -> StoreT:
    """Return a store of a subclass, for example one whose writes fail, on the same database."""
    return kind(store.database, store.files, store.robots, store.deletions, store.kinds)
