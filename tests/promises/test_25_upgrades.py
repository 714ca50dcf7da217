"""Promise 25: upgrades keep data, from every released schema, on SQLite and on PostgreSQL."""

import shutil
import sqlite3
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import psycopg
import pytest
from alembic.autogenerate import compare_metadata
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import Connection, Engine, text

from app.storage.database import migration
from app.storage.database.engine import Database, postgresql_engine, sqlite_engine
from app.storage.database.migration import migrate, newest_revision
from app.storage.database.opening import DATABASE_FILE
from app.storage.database.schema import METADATA
from app.storage.database.store import RunStore
from app.storage.run import TABLE
from tests.postgresql import PostgresServer
from tests.promises.released import sample
from tests.storage.stores import BACKENDS, TRIALS, database_url, opened, training

FOLDER = Path(sample.__file__).parent
SCRIPTS = ScriptDirectory(str(Path(migration.__file__).with_name("migrations")))
REVISIONS = [script.revision for script in SCRIPTS.walk_revisions()]

on_both = pytest.mark.parametrize("backend", BACKENDS)


def load(dump: Path, folder: Path, url: str | None) -> None:
    """Restore data folder and database from a dump."""
    if url is None:
        with closing(sqlite3.connect(folder / DATABASE_FILE)) as file:
            file.executescript(dump.read_text())
    else:
        with psycopg.connect(url) as server:
            server.execute(dump.read_bytes())
    database = Database(database_engine(folder, url))
    files = "SELECT about.id, artifacts.file FROM about, artifacts"
    owner, name = database.read(lambda c: tuple(c.execute(text(files)).one()))
    database.close()
    (folder / "artifacts" / owner).mkdir(parents=True)
    (folder / "artifacts" / owner / name).write_bytes(sample.FILE)


def database_engine(folder: Path, url: str | None) -> Engine:
    return sqlite_engine(folder / DATABASE_FILE) if url is None else postgresql_engine(url)


def rows_in(table: str, database: Database) -> int:
    count = text(f"SELECT count(*) FROM {table}")
    found: int = database.read(lambda connection: connection.execute(count).scalar_one())
    return found


def check(store: RunStore, revision: str) -> None:
    runs = [*sample.RUNS, *([sample.EXPERIMENT] if revision >= "0002" else [])]
    assert [run.id for run in store.list().items] == [run.id for run in reversed(runs)]
    if revision >= "0004":
        runs[0] = replace(runs[0], **sample.ANNOTATIONS)
    for run in runs:
        # NaN is not equal to itself; its repr is.
        assert repr(store.get(run.id)) == repr(run)
    if revision >= "0002":
        assert store.trials(sample.EXPERIMENT.id) == TRIALS
    first = sample.RUNS[0].id
    assert store.evaluations(first) == sample.CURVE
    assert store.artifact(first, TABLE) == sample.FILE


@on_both
@pytest.mark.parametrize("revision", REVISIONS)
def test_every_released_schema_migrates(
    revision: str, backend: str, postgresql: PostgresServer, tmp_path: Path
) -> None:
    with database_url(backend, postgresql) as url:
        load(FOLDER / f"{revision}.{backend}.sql", tmp_path, url)
        for _ in range(2):
            with opened(tmp_path, url) as store:
                check(store, revision)
        with opened(tmp_path, url) as store:
            store.create(training("z"))
            store.delete(sample.RUNS[0].id)
            if revision >= "0002":
                store.delete(sample.EXPERIMENT.id)
        database = Database(database_engine(tmp_path, url))
        for table in ("evaluations", "trials", "artifacts"):
            assert rows_in(table, database) == 0
        database.close()


@on_both
def test_the_migrations_result_in_the_current_schema(
    backend: str, postgresql: PostgresServer, tmp_path: Path
) -> None:
    with database_url(backend, postgresql) as url:
        database = Database(database_engine(tmp_path, url))
        migrate(database)

        def differences(connection: Connection) -> object:
            return compare_metadata(MigrationContext.configure(connection), METADATA)

        assert database.read(differences) == []
        database.close()


@on_both
def test_a_failed_migration_is_rolled_back(
    backend: str, postgresql: PostgresServer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A made-up further migration raises halfway."""
    broken = tmp_path / "migrations"
    shutil.copytree(Path(migration.__file__).with_name("migrations"), broken)
    (broken / "versions" / "schema_9999.py").write_text(
        "from alembic import op\n"
        f"revision, down_revision = '9999', '{newest_revision()}'\n"
        "def upgrade():\n"
        "    op.execute('ALTER TABLE runs ADD COLUMN half INTEGER')\n"
        "    op.execute('UPDATE runs SET half = 1')\n"
        "    raise RuntimeError('halfway')\n"
    )
    config = migration._config()
    config.set_main_option("script_location", str(broken))
    with database_url(backend, postgresql) as url:
        with opened(tmp_path, url) as store:
            sample.put(store)
        with monkeypatch.context() as patch:
            patch.setattr(migration, "_config", lambda: config)
            with pytest.raises(RuntimeError, match="halfway"), opened(tmp_path, url):
                pass
        with opened(tmp_path, url) as store:
            check(store, newest_revision())
            store.create(training("z"))


def test_every_schema_has_its_dumps() -> None:
    dumps = {path.name for path in FOLDER.glob("*.sql")}
    assert dumps == {f"{revision}.{backend}.sql" for revision in REVISIONS for backend in BACKENDS}
