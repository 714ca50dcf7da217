"""viser without a listener: the same stream as on viser's own port, but no socket and no tunnel."""

import asyncio
import contextlib
import threading
from collections.abc import Iterator
from typing import Any

import msgspec
import psutil
import pytest
import viser
from viser import _messages
from viser.infra import _infra
from websockets.sync.client import connect
from websockets.typing import Subprotocol

from app.viewer.snapshot import Snapshot
from hexapods.drawing.viser_internals import stream
from hexapods.drawing.viser_internals.server import InProcessViser, in_process_viser
from tests.viewer.serving import Reader, Robots, array, has_message, wait_until

is_complete = has_message("ReplayDoneMessage")


@pytest.fixture
def listening_viser() -> Iterator[viser.ViserServer]:
    """An unmodified viser server, with its port on loopback."""
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield server
    server.stop()


def draw(server: viser.ViserServer) -> None:
    server.scene.add_frame("/world", show_axes=False)
    server.scene.add_label("/world/label", "a word")
    server.initial_camera.position = (0.0, -1.5, 0.8)
    Robots(server).move_to(3)
    server.scene.add_frame("/world/gone").remove()


def compacted(frames: list[stream.Frame]) -> list[bytes]:
    """Return the compacted messages of a stream, without random ids, as sorted JSON."""
    snapshot = Snapshot()
    for frame in frames:
        snapshot.apply(frame)
    packed = snapshot.pack()
    messages = [plain(message, packed) for message in packed.messages]
    return sorted(msgspec.json.encode({**item, "uuid": "", "run_id": ""}) for item in messages)


def plain(value: Any, frame: stream.Frame) -> Any:
    if isinstance(value, dict) and "__binary_index" in value:
        return bytes(frame.buffers[value["__binary_index"]]).hex()
    if isinstance(value, dict):
        return {key: plain(item, frame) for key, item in value.items()}
    return value


def sockets() -> set[Any]:
    return set(psutil.Process().net_connections(kind="inet"))


def test_stream_equals_the_one_on_visers_own_port(
    listening_viser: viser.ViserServer,
) -> None:
    draw(listening_viser)
    with in_process_viser() as viser_server, Reader(viser_server) as reader:
        draw(viser_server)
        in_process = reader.frames_until(is_complete)
    over_socket: list[stream.Frame] = []
    url, protocol = f"ws://127.0.0.1:{listening_viser.get_port()}/", Subprotocol(stream.SUBPROTOCOL)
    with connect(url, subprotocols=[protocol], compression=None, max_size=None, proxy=None) as ws:
        while not (over_socket and is_complete(over_socket[-1])):
            over_socket.append(stream.parse(ws.recv(30, decode=False)))

    assert compacted(in_process) == compacted(over_socket)


def test_no_socket_is_opened() -> None:
    before = sockets()
    with in_process_viser() as server, Reader(server) as reader:
        reader.frames_until(is_complete)

        assert sockets() == before


def test_share_url_request_opens_no_tunnel(viser_server: InProcessViser) -> None:
    children, before = psutil.Process().children(recursive=True), sockets()
    loop, server = viser_server._event_loop, viser_server._websock_server
    for message in (_messages.ShareUrlRequest(), _messages.ShareUrlDisconnect()):
        handling = server._handle_incoming_message(_infra.ClientId(0), message)
        asyncio.run_coroutine_threadsafe(handling, loop).result(10)
    viser_server._thread_executor.submit(lambda: None).result(10)

    assert viser_server.request_share_url() is None
    viser_server.disconnect_share_url()
    assert viser_server._share_tunnel is None
    assert psutil.Process().children(recursive=True) == children
    assert sockets() == before


def test_slow_reader_gets_coalesced_frames(viser_server: InProcessViser) -> None:
    robots = Robots(viser_server)
    with Reader(viser_server) as reader:
        reader.frames_until(is_complete)
        for place in range(200):
            robots.move_to(place)
        frames = reader.frames_until(
            lambda frame: (
                (places := array(frame, Robots.NAME, "batched_positions")) is not None
                and places[0] == 199
            )
        )

    assert len(frames) < 20


def test_readers_can_be_closed_and_opened_again(viser_server: InProcessViser) -> None:
    for _ in range(3):
        with Reader(viser_server) as reader:
            assert is_complete(reader.frames_until(is_complete)[-1])
    wait_until(lambda: not viser_server._websock_server.get_message_buffer().generator_cursors)


def test_stream_ends_when_viser_stops() -> None:
    with in_process_viser() as server:
        reader = Reader(server)
        reader.frames_until(is_complete)
    with reader, pytest.raises(ConnectionError, match="viser has stopped"):
        reader.frame()
    with Reader(server) as late, pytest.raises(ConnectionError, match="viser has stopped"):
        late.frame()
    assert not server._websock_server._server_thread.is_alive()  # type: ignore[union-attr]


def test_reader_with_a_closed_loop_does_not_block_viser() -> None:
    async def read_some(server: InProcessViser) -> None:
        async with contextlib.aclosing(server.frames()) as frames:
            await anext(frames)

    threads = threading.active_count()
    with in_process_viser() as server:
        asyncio.run(read_some(server))
        Robots(server).move_to(1)
        with Reader(server) as reader:
            reader.frames_until(is_complete)
    assert threading.active_count() <= threads
