"""viser that only draws: it opens nothing, and leaves the console as it was."""

import threading

import psutil
import rich

from hexapods.drawing.viser_internals.recorder import recorder
from hexapods.drawing.viser_internals.server import recorded_viser


def test_it_has_neither_a_socket_nor_a_thread() -> None:
    process = psutil.Process()
    with recorded_viser():  # the event loop that all share has a pair of sockets while it is made
        before = (set(process.net_connections()), set(threading.enumerate()))
    with recorded_viser() as server, recorder(server) as recording:
        server.scene.add_frame("/world")

        assert (set(process.net_connections()), set(threading.enumerate())) == before
        assert "/world" in {message.get("name") for message in recording.take().messages}
        assert server.request_share_url() is None


def test_the_scene_before_a_recorder_is_taken_by_it() -> None:
    with recorded_viser() as server:
        frame = server.scene.add_frame("/world")
        with recorder(server) as first:
            frame.position = (1.0, 2.0, 3.0)
            types = [message["type"] for message in first.take().messages]

    assert types.index("FrameMessage") < types.index("SetPositionMessage")


def test_threads_that_draw_at_once_leave_the_console_as_it_was() -> None:
    console, printing = rich.get_console(), rich.print

    def draw() -> None:
        for _ in range(5):
            with recorded_viser():
                pass

    threads = [threading.Thread(target=draw) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()

    assert rich.print is printing
    assert not console.quiet
