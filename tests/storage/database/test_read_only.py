"""Read-only store: reads while the server runs, and cannot write."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from sqlalchemy import create_engine, text

from app.settings import Settings
from app.storage.database.opening import DATABASE_FILE
from app.storage.database.read_only import open_read_only
from app.storage.errors import NotFound, StorageFailed
from app.storage.run import RUNNING, TABLE
from hexapods.domain.errors import InvalidInput
from tests.storage.stores import BACKENDS, database_url, opened, training


@pytest.fixture(params=BACKENDS)
def settings(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Settings]:
    server = request.param == "postgresql" and request.getfixturevalue("postgresql")
    with database_url(request.param, server) as url:
        yield Settings(data=tmp_path / "data ü?#%", database_url=url)


def test_store_is_readable_while_its_server_runs(settings: Settings) -> None:
    with opened(settings.data, settings.database_url) as store:
        store.create(training("a", state="running"), training("b"))
        store.put_artifact("a", TABLE, b"learned")
        store.curves.append("a", [{"step": 5, "distance_m": 0.5, "epsilon": 0.5}])
        with open_read_only(settings) as reader, open_read_only(settings) as second:
            assert [run.id for run in reader.list().items] == ["b", "a"]
            # Opening read-only does not mark runs as interrupted.
            assert second.get("a").state == "running"
            assert reader.artifact("a", TABLE) == b"learned"
            assert reader.curves.get("a") == store.curves.get("a")
            store.change("a", RUNNING, "finished")
            assert reader.get("a").state == "finished"
    with open_read_only(settings) as reader:
        assert reader.get("b").state == "queued"


def test_writes_are_refused(settings: Settings) -> None:
    with opened(settings.data, settings.database_url) as store:
        store.create(training("a", state="finished"))
        with open_read_only(settings) as reader:
            for change in (
                lambda: reader.delete("a"),
                lambda: reader.create(training("b")),
                lambda: reader.update("a", name="x"),
            ):
                with pytest.raises(StorageFailed):
                    change()
        assert store.get("a").name == "training a"


def test_unused_data_folder_is_an_empty_store(settings: Settings) -> None:
    with open_read_only(settings) as reader:
        assert reader.list().items == []
        with pytest.raises(NotFound):
            reader.get("a")
    assert not settings.data.exists()


def test_schema_of_another_version_is_refused(tmp_path: Path) -> None:
    with opened(tmp_path, None):
        pass
    engine = create_engine(f"sqlite:///{tmp_path / DATABASE_FILE}")
    for version, message in (("9999", "newer version"), ("0000", "newer version")):
        with engine.begin() as connection:
            connection.execute(text(f"UPDATE alembic_version SET version_num = '{version}'"))
        with pytest.raises(InvalidInput, match=message), open_read_only(Settings(data=tmp_path)):
            pass
    engine.dispose()


def test_file_that_is_no_database_is_refused(tmp_path: Path) -> None:
    (tmp_path / DATABASE_FILE).write_text("milk" * 1000)
    with pytest.raises(StorageFailed, match="damaged"), open_read_only(Settings(data=tmp_path)):
        pass
