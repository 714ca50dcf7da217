"""Messages in decoded form: their arrays, and which of them are sent to browsers."""

import numpy as np
from viser import _messages

from hexapods.drawing.viser_internals.messages import array_index, remap_buffers
from hexapods.drawing.viser_internals.recorder import recorder
from hexapods.drawing.viser_internals.server import RecordedViser


def test_remap_buffers_copies_messages_with_their_arrays() -> None:
    first, second, third = (memoryview(bytes([n] * n)) for n in (1, 2, 3))
    message = {"props": {"a": {"__binary_index": 2, "dtype": "<u1"}, "b": [1, None]}}
    target = [first]

    moved = remap_buffers(message, [first, second, third], target)

    assert moved == {"props": {"a": {"__binary_index": 1, "dtype": "<u1"}, "b": [1, None]}}
    assert target == [first, third]
    assert message["props"]["a"] == {"__binary_index": 2, "dtype": "<u1"}


def test_array_of_a_message_is_found_by_its_index(server: RecordedViser) -> None:
    with recorder(server) as recording:
        recording.take()
        vertices = np.arange(9, dtype=np.float32).reshape(3, 3)
        server.scene.add_mesh_simple("/mesh", vertices, np.array([[0, 1, 2]], np.uint32))
        messages, arrays = recording.take()

    props = next(message["props"] for message in messages if message["type"] == "MeshMessage")
    array = arrays[array_index(props["vertices"])]
    assert np.frombuffer(array, props["vertices"]["dtype"]).tolist() == list(range(9))


def test_script_is_not_recorded_among_what_is_drawn(server: RecordedViser) -> None:
    def draw(name: str) -> None:
        script = _messages.RunJavascriptMessage("document.title = 'hacked'")
        server._websock_server.queue_message(script)
        server.scene.add_label(name, "it")

    draw("/before")
    with recorder(server) as recording:
        scene = recording.take()
        draw("/after")
        changes = recording.take()

    for recorded in (scene, changes):
        types = {message["type"] for message in recorded.messages}
        assert "LabelMessage" in types
        assert "RunJavascriptMessage" not in types
