"""Promise 39: another user of the machine gets nothing: reads no file of the server's, takes no
lock, and is answered by no port or socket but the app's own (for ports see promise 29).

As a second local user, if the tests run as root: the system itself refuses. Else by the permissions
of all that this user would need, and the umask of every process.

The data folder is one that an earlier version has left open to everyone. A training, an experiment
with its cluster and a what-if run meanwhile.
"""

import fcntl
import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import psutil
import pytest

from tests.served import BODY, ENDLESS, Served, serving_from

NOBODY = 65534
TOKEN = "only-the-operator-knows-this"
IS_ROOT = os.geteuid() == 0
EXPERIMENT = {
    "experiment": "sweep",
    "simulator": "kinematic",
    "gaits": ["left-right-origin"],
    "seeds": 500,
    "steps": 100,
    "workers": 1,
}


@pytest.fixture
def folder() -> Iterator[Path]:
    """A folder that others may enter, unlike those of pytest."""
    with tempfile.TemporaryDirectory() as path:
        Path(path).chmod(0o755)
        yield Path(path)


@contextmanager
def as_other_user() -> Iterator[None]:
    """Be another user to the file system: its checks are those of the effective ids."""
    groups = os.getgroups()
    os.setgroups([])
    os.setegid(NOBODY)
    os.seteuid(NOBODY)
    try:
        yield
    finally:
        os.seteuid(0)
        os.setegid(0)
        os.setgroups(groups)


def is_refused(attempt: Callable[[], object]) -> bool:
    """Whether another user is refused; by the system if that can be tried."""
    with as_other_user():
        try:
            attempt()
        except PermissionError:
            return True
        except FileNotFoundError:  # of a process that has ended meanwhile
            return True
    return False


def is_closed(path: Path) -> bool:
    """Whether another user can neither open nor lock a file, nor list a folder, nor connect."""
    if not IS_ROOT:
        return any(folder.stat().st_mode & 0o077 == 0 for folder in (path, *path.parents))
    if path.is_dir():
        return is_refused(lambda: list(path.iterdir()))
    return is_refused(lambda: take_lock(path)) and is_refused(lambda: path.open("ab").close())


def take_lock(path: Path) -> None:
    """Take a shared lock, for which reading is enough."""
    with path.open("rb") as file:
        fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)


def open_to_all(data: Path) -> None:
    """Give everyone the permissions that earlier versions left."""
    for path in (data, *data.rglob("*")):
        path.chmod(0o755 if path.is_dir() else 0o644)


def processes(server: Served) -> list[psutil.Process]:
    process = psutil.Process(server.process.pid)
    return [process, *process.children(recursive=True)]


def files_of(process: psutil.Process) -> set[Path]:
    """Return the files that a process has open for writing, and its Unix sockets, by path."""
    with suppress(psutil.Error):
        opened = [Path(file.path) for file in process.open_files() if set(file.mode) & set("wa+")]
        # Of a Unix socket the address is its path, or empty.
        sockets = [Path(str(pair.laddr)) for pair in process.net_connections("unix")]
        return {path for path in (*opened, *sockets) if path.is_absolute() and path.exists()}
    return set()


def umask_of(process: psutil.Process) -> int | None:
    with suppress(OSError):
        status = Path(f"/proc/{process.pid}/status").read_text("utf-8")
        (line,) = [line for line in status.splitlines() if line.startswith("Umask:")]
        return int(line.split()[1], 8)
    return None


def test_no_process_keeps_the_token_in_its_environment(tmp_path: Path) -> None:
    """Agents are code of other people, and programs such as encoders need no token."""
    with serving_from(tmp_path) as launch:
        # Started as a program, whose environment the system shows.
        server = launch(before=("env",), HEXAPODS_TOKEN=TOKEN, HEXAPODS_LOG_LEVEL="warning")
        server.client.headers["Authorization"] = f"Bearer {TOKEN}"
        server.moving(server.start(ENDLESS))
        family = processes(server)
        assert any("forkserver" in " ".join(process.cmdline()) for process in family)
        shown = [Path(f"/proc/{process.pid}/environ").read_bytes() for process in family]
        assert all(b"HEXAPODS_LOG_LEVEL=warning" in environment for environment in shown)
        assert not any(TOKEN.encode() in environment for environment in shown)


def test_another_user_reads_nothing_and_takes_no_lock(folder: Path) -> None:
    control = folder / "control"
    control.write_text("anyone may read this")
    control.chmod(0o644)
    assert not is_closed(control)
    data = folder / "data"
    with serving_from(data) as launch:
        server = launch()
        server.in_state(server.start({**BODY, "steps": 20}), "finished")
        server.end()
        open_to_all(data)
        assert not IS_ROOT or not is_closed(data / "server.lock")

        server = launch()
        training = server.moving(server.start(ENDLESS))
        experiment: dict[str, Any] = server.start(EXPERIMENT, "/experiments")
        server.in_state(experiment, "running")
        server.moving(experiment)
        answer = server.client.post("/api/v1/what-if", json={**BODY, "steps": 5})
        assert answer.status_code == 200, answer.text

        family = processes(server)
        assert len(family) > 4
        opened = {path for process in family for path in files_of(process)}
        assert any(path.suffix == ".db" for path in opened)
        assert any(path.is_socket() for path in opened), "the fork server's"
        paths = {data, *data.rglob("*"), *opened}
        assert [path for path in paths if not is_closed(path)] == []
        assert {umask_of(process) for process in family} <= {0o077, None}
        assert server.look(training)["state"] == "running"
        assert server.end() == 0
