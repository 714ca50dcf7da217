"""Who only looks sees what the server sees, disturbs nothing, and changes nothing."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from sqlalchemy import create_engine, text

from app.domain.errors import InvalidInput
from app.settings import Settings
from app.storage.database.opening import DATABASE_FILE
from app.storage.database.read_only import open_read_only
from app.storage.errors import NotFound, StorageFailed
from app.storage.store import RUNNING, TABLE
from tests.storage.stores import BACKENDS, database_url, opened, training


@pytest.fixture(params=BACKENDS)
def settings(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Settings]:
    server = request.param == "postgresql" and request.getfixturevalue("postgresql")
    with database_url(request.param, server) as url:
        yield Settings(data=tmp_path / "data ü?#%", database_url=url)


def test_a_store_is_looked_into_while_its_server_runs(settings: Settings) -> None:
    with opened(settings.data, settings.database_url) as store:
        store.create(training("a", state="running"), training("b"))
        store.put_artifact("a", TABLE, b"learned")
        store.append_evaluations("a", [{"step": 5, "distance_m": 0.5, "epsilon": 0.5}])
        with open_read_only(settings) as seen, open_read_only(settings) as seen_too:
            assert [run.id for run in seen.list().items] == ["b", "a"]
            # Nobody has taken its server for dead.
            assert seen_too.get("a").state == "running"
            assert seen.artifact("a", TABLE) == b"learned"
            assert seen.evaluations("a") == store.evaluations("a")
            store.change("a", RUNNING, "finished")
            assert seen.get("a").state == "finished"
    with open_read_only(settings) as seen:
        assert seen.get("b").state == "queued"


def test_nothing_can_be_changed(settings: Settings) -> None:
    with opened(settings.data, settings.database_url) as store:
        store.create(training("a", state="finished"))
        with open_read_only(settings) as seen:
            for change in (
                lambda: seen.delete("a"),
                lambda: seen.create(training("b")),
                lambda: seen.update("a", name="x"),
            ):
                with pytest.raises(StorageFailed):
                    change()
        assert store.get("a").name == "training a"


def test_where_no_server_has_been_there_is_nothing(settings: Settings) -> None:
    with open_read_only(settings) as seen:
        assert seen.list().items == []
        with pytest.raises(NotFound):
            seen.get("a")
    assert not settings.data.exists()


def test_another_versions_database_is_not_guessed_at(tmp_path: Path) -> None:
    with opened(tmp_path, None):
        pass
    engine = create_engine(f"sqlite:///{tmp_path / DATABASE_FILE}")
    for version, said in (("9999", "newer version"), ("0000", "newer version")):
        with engine.begin() as connection:
            connection.execute(text(f"UPDATE alembic_version SET version_num = '{version}'"))
        with pytest.raises(InvalidInput, match=said), open_read_only(Settings(data=tmp_path)):
            pass
    engine.dispose()


def test_a_file_that_is_no_database_is_refused(tmp_path: Path) -> None:
    (tmp_path / DATABASE_FILE).write_text("milk" * 1000)
    with pytest.raises(InvalidInput, match="damaged"), open_read_only(Settings(data=tmp_path)):
        pass
