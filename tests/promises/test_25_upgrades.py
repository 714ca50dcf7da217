"""Promise 25: upgrades keep data, from every released schema, on SQLite and on PostgreSQL."""

import shutil
import sqlite3
import zipfile
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import psycopg
import pytest
from alembic.autogenerate import compare_metadata
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import Connection, Engine, text

import hexapods
from app.events.run_view import run_view
from app.features.experiments.trial_rows import Trials
from app.storage.database import migration
from app.storage.database.engine import Database, postgresql_engine, sqlite_engine
from app.storage.database.migration import migrate, newest_revision
from app.storage.database.opening import DATABASE_FILE
from app.storage.database.store import RunStore
from app.storage.run import TABLE
from app.storage.run_ids import RunIds
from tests.features.archives.exported import import_run
from tests.postgresql import PostgresServer
from tests.promises.released import sample
from tests.storage.all_tables import ALL_METADATA
from tests.storage.stores import BACKENDS, TRIALS, database_url, opened, training

pytestmark = pytest.mark.test

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
        assert store.get(run.id) == run
    if revision >= "0002":
        assert Trials(store.database).get(sample.EXPERIMENT.id) == TRIALS
    first = sample.RUNS[0].id
    assert store.curves.get(first) == sample.CURVE
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


def test_a_data_folder_of_version_0_1_opens_with_all_its_runs(tmp_path: Path) -> None:
    """Settings stood beside the other fields then: in rows, tables, checkpoints and archives."""
    with zipfile.ZipFile(FOLDER / "version_0_1.zip") as archive:
        archive.extractall(tmp_path)
    with opened(tmp_path / "data", None) as store:
        views = {run.kind: run_view(run) for run in store.list().items if run.kind is not None}
        rates = {"alpha": 0.3, "gamma": 0.9, "epsilon_start": 1.0, "epsilon_end": 0.0}
        assert views["training"]["config"]["settings"] == rates
        changes = [{"step": 3, "settings": {"alpha": 0.25}}, {"step": 9, "pace": "max"}]
        assert views["training"]["changes"] == changes
        lanes = views["race"]["config"]["lanes"]
        assert [(lane["agent"], lane["settings"]) for lane in lanes] == [
            ("q-learning", {}),
            ("greedy", {}),
        ]
        lists = {name: [value] for name, value in rates.items()}
        assert views["experiment"]["config"]["settings"] == lists

        # Each archive of that version is taken in, and is the run that the data folder has.
        with opened(tmp_path / "new", None) as other:
            ids = RunIds()
            for file in sorted((tmp_path / "archives").iterdir()):
                imported = import_run(other, file.read_bytes(), ids, file.name)
                assert imported == store.get(imported.id)

        practised = hexapods.load(tmp_path / "q.npz")
        assert isinstance(practised, hexapods.Training)
        assert practised.config == store.get(views["training"]["id"]).config
        assert hexapods.evaluate(practised) == views["training"]["result"]["distance_m"]


@on_both
def test_the_migrations_result_in_the_current_schema(
    backend: str, postgresql: PostgresServer, tmp_path: Path
) -> None:
    with database_url(backend, postgresql) as url:
        database = Database(database_engine(tmp_path, url))
        migrate(database)

        def differences(connection: Connection) -> object:
            return compare_metadata(MigrationContext.configure(connection), ALL_METADATA)  # type: ignore[arg-type]  # it takes several

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
    with database_url(backend, postgresql) as url:
        with opened(tmp_path, url) as store:
            sample.put(store)
        with monkeypatch.context() as patch:
            patch.setattr(migration, "SCRIPT_LOCATION", str(broken))
            with pytest.raises(RuntimeError, match="halfway"), opened(tmp_path, url):
                pass
        with opened(tmp_path, url) as store:
            check(store, newest_revision())
            store.create(training("z"))


def test_every_schema_has_its_dumps() -> None:
    dumps = {path.name for path in FOLDER.glob("*.sql")}
    assert dumps == {f"{revision}.{backend}.sql" for revision in REVISIONS for backend in BACKENDS}
