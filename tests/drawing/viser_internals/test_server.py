"""viser without a listener: it has no socket, no thread and no tunnel."""

import asyncio
import threading
from typing import Any

import numpy as np
import psutil
import viser
from viser import _messages
from viser.infra import _infra

from hexapods.drawing.viser_internals.recorder import recorder
from hexapods.drawing.viser_internals.server import RecordedViser, recorded_viser


def draw(server: viser.ViserServer) -> None:
    server.scene.add_frame("/world", show_axes=False)
    server.scene.add_label("/world/label", "a word")
    server.initial_camera.position = (0.0, -1.5, 0.8)
    batch = server.scene.add_batched_meshes_simple(
        "/world/robots",
        np.eye(3, dtype=np.float32),
        np.array([[0, 1, 2]], np.uint32),
        batched_wxyzs=np.tile([1.0, 0.0, 0.0, 0.0], (4, 1)),
        batched_positions=np.zeros((4, 3), np.float32),
    )
    batch.batched_positions = np.full((4, 3), 3, np.float32)
    server.scene.add_frame("/world/gone").remove()


def sockets() -> set[Any]:
    return set(psutil.Process().net_connections(kind="inet"))


def test_no_socket_is_opened() -> None:
    before = sockets()
    with recorded_viser() as server:
        draw(server)
        with recorder(server) as recording:
            recording.take()

        assert sockets() == before


def test_share_url_request_opens_no_tunnel(server: RecordedViser) -> None:
    children, before = psutil.Process().children(recursive=True), sockets()
    websock_server = server._websock_server
    for message in (_messages.ShareUrlRequest(), _messages.ShareUrlDisconnect()):
        handling = websock_server._handle_incoming_message(_infra.ClientId(0), message)
        asyncio.run(handling)
    server._thread_executor.submit(lambda: None).result(10)

    assert server.request_share_url() is None
    server.disconnect_share_url()
    assert server._share_tunnel is None
    assert psutil.Process().children(recursive=True) == children
    assert sockets() == before


def test_no_thread_is_started() -> None:
    before = set(threading.enumerate())
    with recorded_viser() as server:
        draw(server)

        assert set(threading.enumerate()) <= before
