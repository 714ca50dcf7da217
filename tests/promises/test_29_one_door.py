"""Promise 29: one door. Every listening socket of the server and its children is guarded like the
app's own, or other users cannot reach it; and no connection ever leaves the machine.

A training, a race and an experiment run while a hostile viewer sends every message type that viser
has, `ShareUrlRequest` among them. All sockets are looked at twice a second, and an audit
hook in every process of the tree writes down what is connected to, looked up and started, so that
no short connection is missed. The gate's short form watches one round, `make soak` ten.
"""

import ipaddress
import os
import socket
import ssl
import stat
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import msgspec
import psutil
import pytest
from viser import _messages

from tests.promises.length import at_length
from tests.served import BODY, Served, serving_from
from tests.viewer.serving import Viewer

ROUNDS = at_length(1, 10)
EXPERIMENT = {
    "experiment": "sweep",
    "seeds": at_length(2, 10),
    "simulator": "kinematic",
    "gaits": "left-right-origin",
    "steps": 40,
    "alpha": [0.1, 0.5],
    "workers": 2,
}
RACE = {**BODY, "steps": 5, "lanes": [{"agent": "greedy"}, {"agent": "two-step"}]}
TOKEN = "only-the-operator-knows-this"
_AUDITED = Path(__file__).with_name("audited")
_INET = {socket.AF_INET, socket.AF_INET6}


class Sockets:
    """All that a tree of processes had open while it was watched."""

    def __init__(self, pid: int) -> None:
        self._server = psutil.Process(pid)
        self.listening: set[tuple[str, int]] = set()
        self.guarded: dict[tuple[str, int], str] = {}
        """How each listener but the app's own answers whoever has no certificate."""
        self.unix: set[str] = set()
        self.peers: set[tuple[str, int]] = set()
        self.looks = 0

    def look(self) -> None:
        self.looks += 1
        for process in [self._server, *self._server.children(recursive=True)]:
            with suppress(psutil.Error):
                for one in process.net_connections(kind="all"):
                    self._note(one)

    def _note(self, one: Any) -> None:
        if one.family not in _INET:
            if one.laddr:
                self.unix.add(one.laddr)
            return
        if one.raddr:
            self.peers.add((one.raddr.ip, one.raddr.port))
        elif one.status == psutil.CONN_LISTEN or one.type == socket.SOCK_DGRAM:
            address = (one.laddr.ip, one.laddr.port)
            if address not in self.listening:
                self.listening.add(address)
                self.guarded[address] = answer_to_a_stranger(*address)


def answer_to_a_stranger(host: str, port: int) -> str:
    """`refused` if a listener lets nobody in without a certificate; else what it said."""
    asked = b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n"
    with suppress(OSError), socket.create_connection((host, port), timeout=3) as plain:
        plain.sendall(asked)
        if said := plain.recv(100):
            return f"to plain HTTP: {said!r}"
    context = ssl.create_default_context()
    context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    with (
        suppress(OSError),
        socket.create_connection((host, port), timeout=3) as below,
        context.wrap_socket(below) as secure,
    ):
        secure.sendall(asked)
        # TLS 1.3 refuses a missing certificate only after the client's side is done.
        if said := secure.recv(100):
            return f"to TLS without a certificate: {said!r}"
    return "refused"


@contextmanager
def watched(server: Served) -> Iterator[Sockets]:
    sockets, over = Sockets(server.process.pid), threading.Event()

    def watch() -> None:
        while not over.wait(0.5):
            sockets.look()

    thread = threading.Thread(target=watch)
    thread.start()
    try:
        yield sockets
    finally:
        over.set()
        thread.join()


def hostile_messages() -> list[bytes]:
    """Every message type of viser, as short and as long as one pleases to send it."""
    said = [{"type": cls.__name__} for cls in _messages.Message.get_subclasses()]
    assert {"type": "ShareUrlRequest"} in said
    javascript = {"type": "RunJavascriptMessage", "source": "1"}
    return [msgspec.msgpack.encode(one) for one in [*said, javascript]]


def attack(server: Served) -> None:
    port = int(server.address.rpartition(":")[2])
    with Viewer(f"ws://127.0.0.1:{port}/viewer/") as viewer:
        for message in hostile_messages():
            viewer.socket.send(message)
        viewer.socket.ping().wait(10)
        assert viewer.frame().raw


def wait_for_trials(server: Served, run: dict[str, Any]) -> None:
    """All of an experiment's trials; its report, which comes then, opens nothing.

    Its processes are at nice 15: beside others that keep all cores busy it takes minutes.
    """
    deadline = time.monotonic() + 600
    while server.look(run)["progress"]["done"] < run["progress"]["total"]:
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
def test_nothing_listens_but_the_app_and_nothing_leaves(server: Served, audit: Path) -> None:
    server.client.headers["Authorization"] = f"Bearer {TOKEN}"
    own = int(server.address.rpartition(":")[2])
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
            server.client.get(f"/api/v1/races/{runs[1]['id']}/recording?format=viser")
            # At what is left once everything has ended, too.
            seen = sockets.looks
            while sockets.looks < seen + 2:
                time.sleep(0.05)

    others = {address: sockets.guarded[address] for address in sockets.listening}
    del others["127.0.0.1", own]
    assert others, "an experiment's cluster was not seen: this test looks at nothing"
    assert set(others.values()) == {"refused"}, others
    assert all(ipaddress.ip_address(host).is_loopback for host, _ in sockets.listening)
    assert all(ipaddress.ip_address(host).is_loopback for host, _ in sockets.peers)
    for path in filter(os.path.exists, sockets.unix):
        assert stat.S_IMODE(Path(path).stat().st_mode) & 0o077 == 0, path
    check_audit(audit.read_text("utf-8").splitlines())


def check_audit(lines: list[str]) -> None:
    """No process has connected to, or looked up, anything but this machine."""
    assert any(line.startswith("socket.connect ") for line in lines)
    for line in lines:
        event, _, said = line.partition(" ")
        if not event.startswith("socket."):
            continue
        if event == "socket.getaddrinfo":
            assert is_of_this_machine(said.strip("(").split(",")[0].strip("'\"")), line
        elif event in ("socket.connect", "socket.sendto", "socket.sendmsg", "socket.bind"):
            host = said.strip("(").split(",")[0].strip("'\"")
            assert host.startswith("/") or is_of_this_machine(host), line
        else:
            raise AssertionError(line)
