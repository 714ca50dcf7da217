"""Promise 25: upgrades keep data, on SQLite and PostgreSQL; data of before 0.3 is refused."""

import hashlib
import shutil
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import replace
from pathlib import Path

import psycopg
import pytest
from alembic.autogenerate import compare_metadata
from alembic.runtime.migration import MigrationContext
from sqlalchemy import Connection, Engine, text

import hexapods
from app.active_features import migrate_tables
from app.features.experiments.feature import ExperimentFeature
from app.features.experiments.trial_rows import Trials
from app.installed_features import load
from app.settings import Settings
from app.storage.database import migration
from app.storage.database.engine import Database, postgresql_engine, sqlite_engine
from app.storage.database.migration import migrate, migrate_feature, newest_revision
from app.storage.database.opening import DATABASE_FILE, open_store
from app.storage.database.store import RunStore
from app.storage.run import TABLE
from app.storage.run_ids import RunIds
from hexapods.domain.errors import DamagedFile, InvalidInput
from tests.features.archives.exported import import_run
from tests.postgresql import PostgresServer
from tests.promises import sample_runs
from tests.storage.all_tables import ALL_METADATA
from tests.storage.stores import BACKENDS, TRIALS, database_url, opened, training

pytestmark = pytest.mark.test

VERSION_0_1 = Path(__file__).with_name("version_0_1.zip")
"""A data folder, archives and a table of a version before 0.3."""
CORE = Path(migration.__file__).with_name("migrations")

on_both = pytest.mark.parametrize("backend", BACKENDS)


@contextmanager
def database_in(folder: Path, url: str | None) -> Iterator[Database]:
    engine: Engine = (
        sqlite_engine(folder / DATABASE_FILE) if url is None else postgresql_engine(url)
    )
    with closing(Database(engine)) as database:
        yield database


def check_sample(store: RunStore) -> None:
    first, *later_runs = sample_runs.RUNS
    runs = [replace(first, **sample_runs.ANNOTATIONS), *later_runs, sample_runs.EXPERIMENT]
    assert [run.id for run in store.list().items] == [run.id for run in reversed(runs)]
    for run in runs:
        assert store.get(run.id) == run
    assert Trials(store.database).get(sample_runs.EXPERIMENT.id) == TRIALS
    assert store.curves.get(first.id) == sample_runs.CURVE
    assert store.artifact(first.id, TABLE) == sample_runs.FILE


def write_revision(folder: Path, before: str, revision: str, *upgrade: str) -> None:
    """Write a made-up next revision, with the lines of its `upgrade`."""
    lines = "".join(f"    {line}\n" for line in upgrade)
    (folder / f"{revision}.py").write_text(
        "from alembic import op\n"
        f"revision, down_revision = {revision!r}, {before!r}\n"
        f"def upgrade():\n{lines}"
    )


@on_both
def test_a_next_version_migrates_the_core_and_each_feature(
    backend: str, postgresql: PostgresServer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A made-up next version has one more column in `runs` and in `trials`, filled from others."""
    core, trials = tmp_path / "core", tmp_path / "trials"
    assert ExperimentFeature.migrations is not None
    assert ExperimentFeature.tables is not None
    shutil.copytree(CORE, core)
    shutil.copytree(ExperimentFeature.migrations, trials)
    write_revision(
        core / "versions",
        newest_revision(),
        "core_9999",
        "op.execute('ALTER TABLE runs ADD COLUMN title VARCHAR')",
        "op.execute(\"UPDATE runs SET title = kind || ' ' || id\")",
    )
    write_revision(
        trials,
        "experiments_0001",
        "experiments_9999",
        "op.execute('ALTER TABLE trials ADD COLUMN compute_ms DOUBLE PRECISION')",
        "op.execute('UPDATE trials SET compute_ms = 1000 * compute_s')",
    )
    with database_url(backend, postgresql) as url:
        with opened(tmp_path, url) as store:
            sample_runs.put(store)
        with monkeypatch.context() as patch:
            patch.setattr(migration, "SCRIPT_LOCATION", str(core))
            for _ in range(2):
                with open_store(Settings(data=tmp_path, database_url=url)) as store:
                    migrate_feature(store.database, "experiments", trials, ExperimentFeature.tables)
                    check_sample(store)
            with database_in(tmp_path, url) as database:
                titles = database.read(
                    lambda c: c.execute(text("SELECT title FROM runs ORDER BY id")).scalars().all()
                )
                assert titles == [
                    f"{run.kind} {run.id}" for run in (*sample_runs.RUNS, sample_runs.EXPERIMENT)
                ]
                times_ms = database.read(
                    lambda c: c.execute(text("SELECT compute_ms FROM trials")).scalars().all()
                )
                assert sorted(times_ms) == sorted(1000 * trial["compute_s"] for trial in TRIALS)
        # This version knows neither revision, and changes nothing.
        with (
            pytest.raises(InvalidInput, match="a newer version of Racing Hexapods"),
            opened(tmp_path, url),
        ):
            pass
        folder, tables = ExperimentFeature.migrations, ExperimentFeature.tables
        refused = pytest.raises(InvalidInput, match="a newer version of the feature experiments")
        with database_in(tmp_path, url) as database, refused:
            migrate_feature(database, "experiments", folder, tables)


@on_both
def test_the_migrations_result_in_the_current_schema(
    backend: str, postgresql: PostgresServer, tmp_path: Path
) -> None:
    with database_url(backend, postgresql) as url, opened(tmp_path, url) as store:
        migrate(store.database)
        migrate_tables(load().classes, store.database)

        def differences(connection: Connection) -> list[object]:
            changes = compare_metadata(MigrationContext.configure(connection), ALL_METADATA)  # type: ignore[arg-type]  # it takes several
            return [change for change in changes if "alembic_version_" not in str(change)]

        assert store.database.read(differences) == []


@on_both
def test_a_failed_migration_is_rolled_back(
    backend: str, postgresql: PostgresServer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A made-up further migration raises halfway."""
    broken = tmp_path / "migrations"
    shutil.copytree(CORE, broken)
    write_revision(
        broken / "versions",
        newest_revision(),
        "core_9999",
        "op.execute('ALTER TABLE runs ADD COLUMN half INTEGER')",
        "op.execute('UPDATE runs SET half = 1')",
        "raise RuntimeError('halfway')",
    )
    with database_url(backend, postgresql) as url:
        with opened(tmp_path, url) as store:
            sample_runs.put(store)
        with monkeypatch.context() as patch:
            patch.setattr(migration, "SCRIPT_LOCATION", str(broken))
            with pytest.raises(RuntimeError, match="halfway"), opened(tmp_path, url):
                pass
        with opened(tmp_path, url) as store:
            check_sample(store)
            store.create(training("z"))


def digests(folder: Path) -> Mapping[Path, str]:
    return {
        path: hashlib.sha256(path.read_bytes()).hexdigest()
        for path in folder.rglob("*")
        if path.is_file()
    }


def test_data_of_a_version_before_0_3_is_refused_and_left_as_it_is(tmp_path: Path) -> None:
    with zipfile.ZipFile(VERSION_0_1) as archive:
        archive.extractall(tmp_path / "before")
    before = digests(tmp_path / "before")
    with (
        pytest.raises(InvalidInput, match=r"before 0\.3 made this database .*left as it is"),
        opened(tmp_path / "before" / "data", None),
    ):
        pass
    with opened(tmp_path / "new", None) as store:
        for file in sorted((tmp_path / "before" / "archives").iterdir()):
            with pytest.raises(DamagedFile, match="has format 1; this version reads 2 alone"):
                import_run(store, file.read_bytes(), RunIds(), file.name)
        assert store.list().items == []
    with pytest.raises(DamagedFile, match="has format 1; this version reads 2 alone"):
        hexapods.load(tmp_path / "before" / "q.npz")
    after = digests(tmp_path / "before")
    assert {path: after.get(path) for path in before} == before


def test_a_database_of_a_version_before_0_3_is_refused_on_postgresql(
    postgresql: PostgresServer, tmp_path: Path
) -> None:
    with database_url("postgresql", postgresql) as url:
        assert url is not None
        with psycopg.connect(url) as server:
            server.execute("CREATE TABLE alembic_version (version_num VARCHAR(32) PRIMARY KEY)")
            server.execute("INSERT INTO alembic_version VALUES ('0010')")
        with pytest.raises(InvalidInput, match="its schema is 0010"), opened(tmp_path, url):
            pass
        with psycopg.connect(url) as server:
            tables = server.execute("SELECT tablename FROM pg_tables WHERE schemaname = 'public'")
            assert tables.fetchall() == [("alembic_version",)]
