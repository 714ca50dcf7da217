"""viser without a listener: says what viser says on its own port, hears nothing, opens nothing.

Each test names what `app.viewer.in_process` relies on inside viser, for whoever upgrades it.
"""

import asyncio
import contextlib
import inspect
import threading
from collections.abc import Iterator
from typing import Any

import msgspec
import psutil
import pytest
import viser
from viser import _messages, infra
from viser.infra import _infra
from websockets.sync.client import connect
from websockets.typing import Subprotocol

from app.viewer import wire
from app.viewer.in_process import InProcessViser, in_process_viser
from app.viewer.snapshot import Snapshot
from tests.viewer.serving import Reader, Robots, array, eventually, says

DONE = says("ReplayDoneMessage")


@pytest.fixture
def listening() -> Iterator[viser.ViserServer]:
    """viser as it comes, with its port on loopback."""
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield server
    server.stop()


def draw(server: viser.ViserServer) -> None:
    server.scene.add_frame("/world", show_axes=False)
    server.scene.add_label("/world/label", "a word")
    server.initial_camera.position = (0.0, -1.5, 0.8)
    Robots(server).stand_at(3)
    server.scene.add_frame("/world/gone").remove()


def everything(frames: list[wire.Frame]) -> list[bytes]:
    """What a newcomer is told, less what is made of chance."""
    snapshot = Snapshot()
    for frame in frames:
        snapshot.apply(frame)
    packed = snapshot.pack()
    said = [plain(message, packed) for message in packed.messages]
    return sorted(msgspec.json.encode({**one, "uuid": "", "run_id": ""}) for one in said)


def plain(value: Any, frame: wire.Frame) -> Any:
    if isinstance(value, dict) and "__binary_index" in value:
        return bytes(frame.buffers[value["__binary_index"]]).hex()
    if isinstance(value, dict):
        return {key: plain(one, frame) for key, one in value.items()}
    return value


def sockets() -> set[Any]:
    return set(psutil.Process().net_connections(kind="inet"))


def test_a_newcomer_is_told_what_visers_own_client_is_told(
    listening: viser.ViserServer,
) -> None:
    draw(listening)
    with in_process_viser() as stage, Reader(stage) as reader:
        draw(stage)
        here = reader.frames_until(DONE)
    there: list[wire.Frame] = []
    url, protocol = f"ws://127.0.0.1:{listening.get_port()}/", Subprotocol(wire.SUBPROTOCOL)
    with connect(url, subprotocols=[protocol], compression=None, max_size=None, proxy=None) as ws:
        while not (there and DONE(there[-1])):
            there.append(wire.parse(ws.recv(30, decode=False)))

    assert everything(here) == everything(there)


def test_no_socket_is_opened() -> None:
    before = sockets()
    with in_process_viser() as server, Reader(server) as reader:
        reader.frames_until(DONE)

        assert sockets() == before


def test_the_constructor_takes_the_server_that_does_not_listen(stage: InProcessViser) -> None:
    made_by = inspect.getsource(viser.ViserServer.__init__)

    assert "infra.WebsockServer(" in made_by
    assert type(stage._websock_server) is not infra.WebsockServer
    assert type(stage._websock_server)._background_worker is not (
        infra.WebsockServer._background_worker
    )
    assert infra.WebsockServer is _infra.WebsockServer


def test_nothing_else_of_viser_listens_or_connects() -> None:
    """A new listener, or another way to the tunnel, is to be looked at before an upgrade."""
    listens = inspect.getsource(infra.WebsockServer)
    assert listens.count("websockets.asyncio.server.serve(") == 1
    assert "serve(" in inspect.getsource(infra.WebsockServer._background_worker)
    whole = inspect.getsource(inspect.getmodule(viser.ViserServer))  # type: ignore[arg-type]
    assert whole.count("ViserTunnel(") == 1
    assert "ViserTunnel(" in inspect.getsource(viser.ViserServer.request_share_url)


def test_a_request_for_a_tunnel_does_nothing(stage: InProcessViser) -> None:
    children, before = psutil.Process().children(recursive=True), sockets()
    loop, server = stage._event_loop, stage._websock_server
    for message in (_messages.ShareUrlRequest(), _messages.ShareUrlDisconnect()):
        handling = server._handle_incoming_message(_infra.ClientId(0), message)
        asyncio.run_coroutine_threadsafe(handling, loop).result(10)
    stage._thread_executor.submit(lambda: None).result(10)

    assert stage.request_share_url() is None
    stage.disconnect_share_url()
    assert stage._share_tunnel is None
    assert psutil.Process().children(recursive=True) == children
    assert sockets() == before


def test_a_reader_that_waits_is_told_the_newest_and_no_more(stage: InProcessViser) -> None:
    robots = Robots(stage)
    with Reader(stage) as reader:
        reader.frames_until(DONE)
        for place in range(200):
            robots.stand_at(place)
        frames = reader.frames_until(
            lambda frame: (
                (places := array(frame, Robots.NAME, "batched_positions")) is not None
                and places[0] == 199
            )
        )

    assert len(frames) < 20


def test_readers_come_and_go(stage: InProcessViser) -> None:
    for _ in range(3):
        with Reader(stage) as reader:
            assert DONE(reader.frames_until(DONE)[-1])
    eventually(lambda: not stage._websock_server.get_message_buffer().generator_cursors)


def test_the_end_of_viser_ends_its_stream() -> None:
    with in_process_viser() as server:
        reader = Reader(server)
        reader.frames_until(DONE)
    with reader, pytest.raises(ConnectionError, match="viser has stopped"):
        reader.frame()
    with Reader(server) as late, pytest.raises(ConnectionError, match="viser has stopped"):
        late.frame()
    assert not server._websock_server._server_thread.is_alive()  # type: ignore[union-attr]


def test_a_reader_whose_loop_ends_holds_nothing_up() -> None:
    async def read_some(server: InProcessViser) -> None:
        async with contextlib.aclosing(server.frames()) as frames:
            await anext(frames)

    threads = threading.active_count()
    with in_process_viser() as server:
        asyncio.run(read_some(server))
        Robots(server).stand_at(1)
        with Reader(server) as reader:
            reader.frames_until(DONE)
    assert threading.active_count() <= threads
