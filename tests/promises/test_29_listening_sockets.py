"""Promise 29: a single entry point. Of the server and its children only the app's own socket
listens to the network, other users cannot reach the others, and no connection ever leaves the
machine.

A training, a race and an experiment run while a hostile client asks for viser's websocket, and
sends every message type that viser has, `ShareUrlRequest` among them. All sockets are sampled five
times a second, and an audit hook in every process of the tree logs connections, name look-ups and
started programs, so that no short connection is missed. The gate's short form runs one round,
`make soak` ten.
"""

import ipaddress
import os
import socket
import stat
import struct
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import msgspec
import psutil
import pytest
import viser
from viser import _messages

from tests.promises.length import at_length
from tests.promises.raw import UPGRADE
from tests.served import BODY, Served, serving_from
from tests.timeouts import LONG_S

ROUNDS = at_length(1, 10)
EXPERIMENT = {
    "experiment": "sweep",
    "seeds": at_length(2, 10),
    "simulator": "kinematic",
    "gaits": "left-right-origin",
    "steps": 4000,
    "settings": {"alpha": [0.1, 0.5]},
    "workers": 2,
}
RACE = {**BODY, "steps": 5, "lanes": [{"agent": "greedy"}, {"agent": "two-step"}]}
TOKEN = "only-the-operator-knows-this"
_AUDITED = Path(__file__).with_name("audited")
_INET = {socket.AF_INET, socket.AF_INET6}


class Sockets:
    """All sockets that a process tree has had open while it was monitored."""

    def __init__(self, pid: int) -> None:
        self._server = psutil.Process(pid)
        self.listening: set[tuple[str, int]] = set()
        self.names: set[str] = set()
        """Names of the processes."""
        self.unix: set[str] = set()
        self.peers: set[tuple[str, int]] = set()
        self.samples = 0

    def sample(self) -> None:
        self.samples += 1
        for process in [self._server, *self._server.children(recursive=True)]:
            with suppress(psutil.Error):
                self.names.add(process.name())
                for connection in process.net_connections(kind="all"):
                    self._record(connection)

    def _record(self, connection: Any) -> None:
        if connection.family not in _INET:
            if connection.laddr:
                self.unix.add(connection.laddr)
            return
        if connection.raddr:
            self.peers.add((connection.raddr.ip, connection.raddr.port))
        elif connection.status == psutil.CONN_LISTEN or connection.type == socket.SOCK_DGRAM:
            self.listening.add((connection.laddr.ip, connection.laddr.port))


@contextmanager
def watched(server: Served) -> Iterator[Sockets]:
    sockets, finished = Sockets(server.process.pid), threading.Event()

    def watch() -> None:
        while not finished.wait(0.2):
            sockets.sample()

    thread = threading.Thread(target=watch)
    thread.start()
    try:
        yield sockets
    finally:
        finished.set()
        thread.join()


def hostile_messages() -> list[bytes]:
    """Return a message of every type of viser, and one that would run JavaScript."""
    received = [{"type": cls.__name__} for cls in _messages.Message.get_subclasses()]
    assert {"type": "ShareUrlRequest"} in received
    javascript = {"type": "RunJavascriptMessage", "source": "1"}
    return [msgspec.msgpack.encode(message) for message in [*received, javascript]]


def attack(server: Served) -> None:
    """Ask for viser's websocket, and send its messages without waiting for an answer."""
    port = int(server.address.rpartition(":")[2])
    handshake = "".join(f"{name}: {value}\r\n" for name, value in UPGRADE.items())
    protocol = f"Sec-WebSocket-Protocol: viser-v{viser.__version__}\r\n"
    for path in ("/viewer/", "/"):
        head = f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n{handshake}{protocol}\r\n"
        with socket.create_connection(("127.0.0.1", port), LONG_S) as client:
            client.sendall(head.encode())
            assert client.recv(12) == b"HTTP/1.1 200"
            with suppress(ConnectionError):
                for message in hostile_messages():
                    client.sendall(frame_of(message))
                while client.recv(1 << 16):
                    pass


def frame_of(message: bytes) -> bytes:
    """Return a message as a client's websocket frame (RFC 6455), masked with zeros."""
    return struct.pack("!BBH4x", 0x82, 0x80 | 126, len(message)) + message


def wait_for_trials(server: Served, run: dict[str, Any]) -> None:
    """Wait for all of an experiment's trials, not for its report, which opens no sockets.

    Its processes run at nice 15: on a busy machine it takes minutes.
    """
    deadline = time.monotonic() + 600
    while (now := server.look(run))["progress"]["done"] < run["progress"]["total"]:
        assert now["state"] != "failed", now["error"]
        assert time.monotonic() < deadline
        time.sleep(0.2)


@pytest.fixture
def audit(tmp_path: Path) -> Path:
    return tmp_path / "audit.txt"


@pytest.fixture
def server(tmp_path: Path, audit: Path) -> Iterator[Served]:
    paths = [str(_AUDITED), *filter(None, [os.environ.get("PYTHONPATH")])]
    with serving_from(tmp_path / "data") as make:
        yield make(
            PYTHONPATH=os.pathsep.join(paths),
            AUDIT_FILE=str(audit),
            HEXAPODS_TOKEN=TOKEN,
        )


def is_of_this_machine(host: str) -> bool:
    return host in ("localhost", "", "None") or ipaddress.ip_address(host).is_loopback


@pytest.mark.timeout(1800)
def test_only_the_app_listens_and_no_connection_leaves_the_machine(
    server: Served, audit: Path
) -> None:
    server.client.headers["Authorization"] = f"Bearer {TOKEN}"
    server_port = int(server.address.rpartition(":")[2])
    with watched(server) as sockets:
        for _ in range(ROUNDS):
            runs = [
                server.start({**BODY, "steps": 200}),
                server.start(RACE, "/races"),
                server.start(EXPERIMENT, "/experiments"),
            ]
            attack(server)
            for run in runs[:2]:
                assert server.in_state(run, "finished", "failed")["state"] == "finished"
            wait_for_trials(server, runs[2])
            page = server.client.get(f"/api/v1/runs/{runs[1]['id']}/page")
            assert page.status_code == 200, page.text
            # Sample the sockets that are left after the runs' ends, too.
            seen = sockets.samples
            while sockets.samples < seen + 2:
                time.sleep(0.05)

    assert sockets.listening == {("127.0.0.1", server_port)}
    assert "trial worker" in sockets.names, "the experiment's processes were sampled"
    assert all(ipaddress.ip_address(host).is_loopback for host, _ in sockets.peers)
    for path in filter(os.path.exists, sockets.unix):
        assert stat.S_IMODE(Path(path).stat().st_mode) & 0o077 == 0, path
    check_audit(audit.read_text("utf-8").splitlines())


def check_audit(lines: list[str]) -> None:
    """Check that no process has connected to, or looked up, another machine."""
    assert any(line.startswith("socket.connect ") for line in lines)
    for line in lines:
        event, _, received = line.partition(" ")
        if not event.startswith("socket."):
            continue
        if event == "socket.getaddrinfo":
            assert is_of_this_machine(received.strip("(").split(",")[0].strip("'\"")), line
        elif event in ("socket.connect", "socket.sendto", "socket.sendmsg", "socket.bind"):
            host = received.strip("(").split(",")[0].strip("'\"")
            assert host.startswith("/") or is_of_this_machine(host), line
        else:
            raise AssertionError(line)
