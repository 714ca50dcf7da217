"""Promise 31: a database has exactly one owner.

A second server on the same data folder or database is refused. If it acquires the lock all the
same, after a restart of PostgreSQL or the removal of the lock file, the first is fenced: it writes
nothing more, ends its jobs and itself, and the runs resumed by the second are bit-exact.
"""

import signal
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

import psutil
import psycopg
import pytest

from app.settings import Settings
from app.storage.database.opening import open_store
from app.storage.database.store import RunStore
from app.storage.errors import OwnershipLost
from app.storage.server_lock import LOCK_FILE
from hexapods.domain.errors import InvalidInput
from tests.postgresql import PostgresServer
from tests.promises.length import at_length
from tests.promises.trainings import uninterrupted
from tests.served import BODY, NotStartedError, serving_from
from tests.storage.stores import BACKENDS, database_url, training
from tests.timeouts import LONG_S

ROUNDS = at_length(1, 20)
PACED = {**BODY, "steps": 600, "pace": 20, "evaluate_every": 100, "seed": 31}


def remove_lock(data: Path, url: str | None) -> None:
    """Release the first server's lock: delete its lock file, end its advisory lock's session."""
    (data / LOCK_FILE).unlink(missing_ok=True)
    if url is not None:
        with psycopg.connect(url, autocommit=True) as connection:
            # Waits for its end: until then the lock still counts as granted.
            connection.execute(
                "SELECT pg_terminate_backend(pid, 30000) FROM pg_locks WHERE locktype = 'advisory'"
            )


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.timeout(at_length(180, 3600))
def test_the_first_of_two_servers_is_fenced(
    backend: str, postgresql: PostgresServer, tmp_path: Path
) -> None:
    for number in range(ROUNDS):
        data = tmp_path / str(number)
        with database_url(backend, postgresql) as url, serving_from(data) as launch:
            variables = {} if url is None else {"HEXAPODS_DATABASE_URL": url}
            first = launch(**variables)
            run = first.start(PACED)
            first.after_step(run, 50)
            children = first.jobs()
            # Simulates a suspended machine or a network partition: it cannot renew its lock.
            first.process.send_signal(signal.SIGSTOP)
            remove_lock(data, url)
            second = launch(**variables)
            first.process.send_signal(signal.SIGCONT)
            assert first.process.wait(LONG_S) == 2, "a fenced server exits with an error"
            _, left = psutil.wait_procs(children, timeout=LONG_S)
            assert not left
            assert second.look(run)["state"] == "interrupted"
            assert second.tell(run, "resume").status_code == 202
            second.hurry(str(run["id"]))
            ended = second.in_state(run, "finished", "failed")
            assert ended["state"] == "finished", ended
            table, curve = uninterrupted(ended["config"], ended["changes"])
            path = f"/api/v1/trainings/{run['id']}"
            assert second.client.get(f"{path}/q-table?format=npz").content == table
            assert second.client.get(f"{path}/curve").json()["evaluations"] == curve


@contextmanager
def second_store(data: Path, settings: Settings, url: str | None) -> Iterator[RunStore]:
    """Open a second store; retries, since the first may reacquire its lock in between."""
    with ExitStack() as stack:
        while True:
            remove_lock(data, url)
            with suppress(InvalidInput):
                yield stack.enter_context(open_store(settings))
                return


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_fenced_server_writes_nothing(
    backend: str, postgresql: PostgresServer, tmp_path: Path
) -> None:
    lost: list[int] = []
    with database_url(backend, postgresql) as url:
        settings = Settings(data=tmp_path, database_url=url)
        with open_store(settings, on_lost=lambda: lost.append(1)) as first:
            first.create(training("a"))
            other = Settings(data=tmp_path / "other", database_url=url)
            with second_store(tmp_path, other if url else settings, url) as second:
                for write in (
                    lambda: first.create(training("b")),
                    lambda: first.update("a", name="c"),
                    lambda: first.put_artifact("a", "q-table.npz", b"late"),
                    lambda: first.delete("a"),
                ):
                    with pytest.raises(OwnershipLost):
                        write()
                assert [run.id for run in second.list().items] == ["a"]
                deadline = time.monotonic() + LONG_S
                while not lost:
                    assert time.monotonic() < deadline
                    time.sleep(0.05)
                second.update("a", name="of the second")
                assert first.get("a").name == "of the second", "a fenced store can still read"


def test_a_server_reacquires_its_lock_after_the_database_restarts(
    postgresql: PostgresServer, tmp_path: Path
) -> None:
    """A second server is then still refused."""
    with postgresql.database() as url, serving_from(tmp_path / "one") as launch:
        first = launch(HEXAPODS_DATABASE_URL=url)
        remove_lock(tmp_path / "one", url)
        deadline = time.monotonic() + LONG_S
        count_locks = "SELECT count(*) FROM pg_locks WHERE locktype = 'advisory' AND granted"
        with psycopg.connect(url, autocommit=True) as connection:
            while connection.execute(count_locks).fetchone() != (1,):
                assert time.monotonic() < deadline
                time.sleep(0.05)
        with serving_from(tmp_path / "two") as launch_other, pytest.raises(NotStartedError):
            launch_other(HEXAPODS_DATABASE_URL=url)
        assert first.client.get("/readyz").status_code == 200
        assert first.end(signal.SIGTERM) == 0
