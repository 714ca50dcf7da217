"""Tests of the assumptions that `hexapods.drawing.viser_internals` lists, one each, by name.

Private parts of viser are imported within the tests, so that each fails for itself in a version
that lacks them. Facts of the browser's side are looked up in the client's minified script.
"""

from __future__ import annotations

import ast
import dataclasses
import inspect
import re
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import rich
import viser
from playwright.sync_api import Page

from hexapods import assets
from hexapods.drawing import viser_internals

if TYPE_CHECKING:
    from hexapods.drawing.viser_internals.server import RecordedViser

PACKAGE = Path(viser.__file__).parent
BUILD = PACKAGE / "client" / "build"


@pytest.fixture
def listening(monkeypatch: pytest.MonkeyPatch) -> Iterator[viser.ViserServer]:
    """An unmodified viser server on loopback, silenced."""
    monkeypatch.setattr(rich.get_console(), "quiet", True)
    server = viser.ViserServer(host="127.0.0.1", port=0)
    yield server
    server.stop()


@pytest.fixture(scope="module")
def client() -> str:
    """The script of viser's client, unpacked."""
    from hexapods.drawing.viser_internals.client import page_scripts

    try:
        return page_scripts((BUILD / "index.html").read_text("utf-8"))[-1].decode()
    except RuntimeError:
        pytest.fail("cannot be checked until `client_is_packed` holds", pytrace=False)


PIXELS = """async () => {
    const canvas = document.querySelector("canvas[data-engine]");
    // A WebGL canvas can be read only before the browser composites the frame.
    await new Promise(requestAnimationFrame);
    __viserMutable.requestRender();
    await new Promise(requestAnimationFrame);
    const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d");
    copy.drawImage(canvas, 0, 0);
    return [0.25, 0.75].map((x) =>
        [...copy.getImageData(x * canvas.width, canvas.height / 2, 1, 1).data]);
}"""
"""Reads the pixels (red, green, blue, alpha) in the middle of the left and of the right half."""


def update(node: str, **properties: object) -> Any:
    from viser import _messages

    return _messages.SceneNodeUpdateMessage(node, properties)


def draw(server: viser.ViserServer, value: float) -> None:
    """Draw the kinds of nodes that are on the stage, and change each of their properties."""
    scene, corners = server.scene, np.eye(3, dtype=np.float32)
    faces = np.array([[0, 1, 2]], np.uint32)
    frame = scene.add_frame("/world", show_axes=False)
    frame.position, frame.wxyz, frame.visible = (value, 0, 0), (0, 1, 0, 0), False
    label = scene.add_label("/world/label", f"{value}")
    label.text, label.font_screen_scale = f"at {value}", value
    scene.add_mesh_simple("/world/mesh", corners, faces).color = (1, 2, 3)
    batch = scene.add_batched_meshes_simple(
        "/world/batch",
        corners,
        faces,
        batched_wxyzs=np.tile([1.0, 0.0, 0.0, 0.0], (2, 1)),
        batched_positions=np.zeros((2, 3)),
    )
    batch.batched_positions = np.full((2, 3), value, np.float32)
    batch.batched_colors = np.full((2, 3), 7, np.uint8)
    scene.add_line_segments("/world/lines", np.zeros((1, 2, 3)), (1, 2, 3))
    scene.add_light_spot("/world/lamp").position = (value, 0, 0)
    scene.set_up_direction("+z")
    scene.configure_default_lights(enabled=False)
    server.initial_camera.position = (value, 0.0, 1.0)
    server.initial_camera.fov = value


def draw_twice(server: viser.ViserServer) -> viser.BatchedMeshHandle:
    """Draw nodes of some kinds, change them, and remove one; returns a batch of two instances."""
    scene = server.scene
    label = scene.add_label("/world/label", "a word")
    batch = scene.add_batched_meshes_simple(
        "/world/batch",
        np.eye(3, dtype=np.float32),
        np.array([[0, 1, 2]], np.uint32),
        batched_positions=np.zeros((2, 3)),
        batched_wxyzs=np.tile((1.0, 0.0, 0.0, 0.0), (2, 1)),
    )
    label.text, label.position = "another", (1.0, 2.0, 3.0)
    batch.batched_positions = np.ones((2, 3), np.float32)
    scene.add_frame("/world/gone").remove()
    return batch


def test_every_assumption_has_its_test() -> None:
    listed = re.findall(r"^- (\w+): ", viser_internals.__doc__ or "", re.MULTILINE)
    tested = [name for name in vars(sys.modules[__name__]) if name.startswith("test_")]

    assert len(listed) == len(set(listed))
    assert {f"test_{name}" for name in listed} == set(tested) - {
        test_every_assumption_has_its_test.__name__,
        test_only_this_package_uses_private_parts.__name__,
    }


@pytest.mark.test
def test_only_this_package_uses_private_parts() -> None:
    """The rest of the app uses only what `viser` itself exports, and not `viser.infra`.

    Private attributes are refused by ruff (SLF001), and `viser` outside `app.viewer` by an import
    contract.
    """
    package = Path(viser_internals.__file__).parent
    used = []
    for path in package.parents[1].rglob("*.py"):
        if path.parent == package:
            continue
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            match node:
                case ast.Import(names):
                    used += [(path.name, alias.name) for alias in names]
                case ast.ImportFrom(module=str(module), names=names):
                    used += [(path.name, f"{module}.{alias.name}") for alias in names]
                case ast.Attribute(value=ast.Name(id="viser"), attr=attribute):
                    used.append((path.name, f"viser.{attribute}"))

    from_viser = [(path, name) for path, name in used if name.split(".")[0] == "viser"]
    assert from_viser
    assert [
        (path, name) for path, name in from_viser if re.search(r"\.(_|infra\b)|\..*\.", name)
    ] == []


# ---- assumed by server


def test_server_class_is_replaceable(monkeypatch: pytest.MonkeyPatch) -> None:
    from viser import infra

    class Replaced(infra.WebsockServer):
        pass

    monkeypatch.setattr(rich.get_console(), "quiet", True)
    monkeypatch.setattr(infra, "WebsockServer", Replaced)

    server = viser.ViserServer(host="127.0.0.1", port=0)
    server.stop()

    assert type(server._websock_server) is Replaced
    assert server._event_loop is server._websock_server._background_event_loop


def test_worker_owns_the_socket() -> None:
    from viser import infra

    server_source = inspect.getsource(infra.WebsockServer)
    worker_source = inspect.getsource(infra.WebsockServer._background_worker)

    assert server_source.count("serve(") == worker_source.count("asyncio.server.serve(") == 1
    assert "self._background_worker(ready_sem)" in inspect.getsource(infra.WebsockServer.start)
    set_by_worker = set(re.findall(r"self\.(\w+) = ", worker_source))
    assert set_by_worker == {
        "_background_event_loop",
        "_stop_event",
        "_broadcast_buffer",
        "_port",  # of the socket
    }


def test_tunnel_has_one_entrance() -> None:
    source = inspect.getsource(sys.modules[viser.ViserServer.__module__])

    assert source.count("ViserTunnel(") == 1
    assert "ViserTunnel(" in inspect.getsource(viser.ViserServer.request_share_url)


def test_prints_go_through_rich(
    listening: viser.ViserServer, capfd: pytest.CaptureFixture[str]
) -> None:
    listening.stop()

    # The fixture has silenced rich, so whatever is here was printed in another way.
    assert capfd.readouterr() == ("", "")


# ---- assumed by messages


def test_closed_loops_wake_nothing(listening: viser.ViserServer) -> None:
    from hexapods.drawing.viser_internals.recorder import recorder
    from hexapods.drawing.viser_internals.server import recorded_viser

    taken = []
    with recorded_viser() as server:
        assert server._websock_server._server_thread is None
        for drawing in (server, listening):
            with recorder(drawing) as recording:
                with drawing.atomic():
                    draw_twice(drawing)
                drawing.flush()
                messages, arrays = recording.take()
            taken.append(([{**m, "uuid": "", "run_id": ""} for m in messages], list(arrays)))
    assert taken[0] == taken[1]
    assert len(taken[0][0]) > 10


def test_types_are_looked_up(server: RecordedViser) -> None:
    from typing import get_type_hints

    frame, other = server.scene.add_frame("/a"), server.scene.add_frame("/b")
    draw_twice(server)

    hints = frame._prop_hints
    assert hints == get_type_hints(type(frame._impl.props))
    assert other._prop_hints is hints, "looked up once for the class"


def test_arrays_are_referenced(client: str) -> None:
    buffers: list[memoryview] = []
    message = update("/a", number=1, array=np.ones(2, np.float32)).as_serializable_dict(buffers)

    assert message["updates"] == {"number": 1, "array": {"__binary_index": 0, "dtype": "<f4"}}
    assert "`__binary_index`in" in client


def test_lifecycle_of_messages() -> None:
    from viser import _messages

    classes = _messages.Message.get_subclasses()

    phases = {cls.lifecycle_phase for cls in classes}
    assert phases == {"create", "update_dict", "update_simple", "remove", None}
    for cls in classes:
        fields = {field.name for field in dataclasses.fields(cls)}  # type: ignore[arg-type]
        if cls.lifecycle_phase is not None:
            assert {cls.entity_id_field} <= fields & {"name", "uuid"}
        if cls.lifecycle_phase == "update_dict":
            assert "updates" in fields
    assert "owner" in _messages.FrameMessage.__dataclass_fields__


def slot_of(message: dict[str, Any]) -> tuple[str, str]:
    """Return the entity of a message and the key of its slot, as `static/js/replay-frames.js`."""
    from hexapods.drawing.viser_internals.messages import LIFECYCLES

    kind, phase, id_field = LIFECYCLES[message["type"]]
    entity = message["type"]
    if kind and id_field:
        entity = f"{kind} {message[id_field]}"
    elif "name" in message:
        entity = f"scene {message['name']}"
    if phase == "create":
        return entity, phase
    fields = ",".join(sorted(message["updates"])) if phase == "update_dict" else ""
    return entity, f"{message['type']} {fields}"


def test_redundancy_of_messages(
    listening: viser.ViserServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    from viser.infra._async_message_buffer import AsyncMessageBuffer

    pushed: list[Any] = []
    push: Callable[..., None] = AsyncMessageBuffer.push

    def recorded(buffer: AsyncMessageBuffer, message: Any) -> None:
        pushed.append(message)
        push(buffer, message)

    monkeypatch.setattr(AsyncMessageBuffer, "push", recorded)
    draw(listening, 1.0)
    draw(listening, 2.0)

    slots: dict[str, set[tuple[str, str]]] = {}
    for message in pushed:
        slot = slot_of(message.as_serializable_dict([]))
        slots.setdefault(message.redundancy_key(), set()).add(slot)
    assert len(pushed) > 40
    # One slot for each of viser's keys, and no slot for two of them.
    assert {len(slots_of_key) for slots_of_key in slots.values()} == {1}
    assert len(set.union(*slots.values())) == len(slots)


def test_commands_to_the_browser(client: str) -> None:
    from hexapods.drawing.viser_internals.messages import BLOCKED_TYPES

    cases = re.findall(r"case`(\w+)`:((?:(?!case`|default:).)*)", client, re.DOTALL)
    pattern = re.compile(r"sendMessage\(|Function\(|getRenderRequest=")
    commands = {name for name, body in cases if pattern.search(body)}

    # These answer to a user's mouse, and the stage has none of them.
    assert commands == BLOCKED_TYPES | {"TransformControlsMessage", "guiUpdate"}


def test_serializers_get_each_message() -> None:
    from hexapods.drawing.viser_internals.recorder import recorder
    from hexapods.drawing.viser_internals.server import recorded_viser

    with recorded_viser() as server:
        frame = server.scene.add_frame("/one")
        with recorder(server) as recording:
            scene = recording.take()
            frame.position = (1.0, 2.0, 3.0)
            server.scene.add_frame("/two")
            changes = recording.take()
            assert recording.take() == ([], [])
        frame.visible = False

    assert "/one" in {message.get("name") for message in scene.messages}
    assert [message["name"] for message in changes.messages][:2] == ["/one", "/two"]


def test_changes_of_an_array_are_plain(server: RecordedViser) -> None:
    from viser import _messages
    from viser.infra import StateSerializer

    from hexapods.drawing.viser_internals.recorder import recorder

    for value in (np.arange(6, dtype=np.float32), np.zeros((2, 3), np.uint8)):
        message = _messages.SceneNodeUpdateMessage("/a", {"batched_positions": value})
        message.owner = "someone"
        with recorder(server) as recording:
            recording.take()
            recording._insert_message(message)
            plain = recording.take()
            StateSerializer._insert_message(recording, message)
            assert recording.take() == plain


# ---- assumed by batches


def test_instances_are_properties(server: RecordedViser) -> None:
    from hexapods.drawing.viser_internals.batches import move_instances
    from hexapods.drawing.viser_internals.recorder import recorder

    batch = draw_twice(server)
    for name, size in (("batched_positions", 3), ("batched_wxyzs", 4)):
        first, second = np.random.default_rng(1).random((2, 2, size)).astype(np.float32)
        setattr(batch, name, first)
        with recorder(server) as recording:
            recording.take()
            setattr(batch, name, second)
            assigned = recording.take()
            move_instances(batch, name, first)
            move_instances(batch, name, second)
            moved = recording.take()
        assert moved.messages[1] == {
            **assigned.messages[0],
            "updates": {name: {"__binary_index": 1, "dtype": "<f4"}},
        }
        assert moved.arrays[1] == assigned.arrays[0]
        assert np.array_equal(getattr(batch, name), second)


# ---- assumed by client


def test_page_is_one_file() -> None:
    assert [path.name for path in BUILD.iterdir()] == ["index.html"]
    html = (BUILD / "index.html").read_text("utf-8")
    assert html.count("<head>") == html.count("<title>Viser</title>") == 1


def test_client_is_packed() -> None:
    from hexapods.drawing.viser_internals.client import _ALPHABET, page_scripts

    loader, unpacked = page_scripts((BUILD / "index.html").read_text("utf-8"))

    digits = re.search(r'const A="((?:[^"\\]|\\.)+)"', loader.decode())
    assert digits is not None
    assert digits[1].replace("\\\\", "\\") == _ALPHABET.decode()
    assert b"viser-v" in unpacked


def test_query_parameters(client: str) -> None:
    from app.viewer.viewer_page import ALLOWED_QUERY

    declared = {"theme"}
    for name in ALLOWED_QUERY - declared:
        assert re.search(rf"\w\(`{name}`\)", client)
    assert "=`websocket`" in client
    # Elsewhere a new parameter might be read.
    assert client.count("URLSearchParams(") == 7


def test_code_from_strings(client: str) -> None:
    made_of = re.findall(r"(?<![\w$.])(?:Function|eval)\(([^)]*)\)", client)

    # Embind in both builds of the sorter, and the message.
    assert made_of == [*["...f,p", "...c,a"] * 2, "n.source"]


def test_worker_connects(client: str) -> None:
    assert "{type:`set_server`,server:" in client
    # The address is null until then, and without it there is no attempt.
    assert client.count("new WebSocket(") == 1
    assert "type===`set_server`?(e=r.server,a()):r.type===`retry`?e!==null&&a():" in client
    assert "s.type===`connected`" in client
    assert "s.type===`message_batch`&&" in client
    assert "ReplayDoneMessage" in client


def test_controls_have_these_selectors(client: str) -> None:
    style = (assets.static_dir() / "viewer" / "patch.css").read_text("utf-8")
    for selector, source in (
        ("[data-floating-window]", '"data-floating-window":'),
        (".mantine-Paper-root", "name:`Paper`"),
        (".mantine-Notifications-root", "(`Notifications`,"),
        ('[title="About Viser"]', "title:`About Viser`"),
    ):
        assert selector in style
        assert source in client


def test_labels_are_taken_out(client: str) -> None:
    for snippet in (
        "type:`message_batch`,messages:",
        "nodeRefFromName",
        "nodePoseData",
        "requestRender",
        "canvas:null",
        "messageQueue:[]",
    ):
        assert snippet in client
    assert client.count(".__viserMutable=") == 1
    # By which messages of the websocket reach the queue.
    assert re.search(r"let n=e\.messageQueue.{,200}n\.push\(r\)", client)
    assert re.search(r"isScene===!0&&\w+\.onAfterRender\(", client)
    assert ".onAfterRender=" not in client


def test_clicks_go_through_the_worker(client: str) -> None:
    from viser import _messages

    binding = _messages.DragBinding("left", None)
    message = _messages.SetSceneNodeClickBindingsMessage("/a", (binding,)).as_serializable_dict()
    script = (assets.static_dir() / "viewer" / "clicks.js").read_text("utf-8")

    assert dataclasses.asdict(binding) == {"button": "left", "modifier": None}
    assert set(message) == {"type", "name", "bindings", "owner"}
    assert {"name", "instance_index"} <= set(_messages.SceneNodeClickMessage.__annotations__)
    assert re.search(r"case`SetSceneNodeClickBindingsMessage`:.{,200}clickBindings:", client)
    assert re.search(
        r"computeClickInstanceIndexFromInstanceId:\w\.type===`BatchedMeshesMessage`\?(\w)=>\1:",
        client,
    )
    assert re.search(r"instance_index:(\w)===void 0\?null:\1\(\w\.instanceId\)", client)
    assert re.search(r"sendMessage=(\w)=>\{.{,150}\(\{type:`send`,message:\1\}\)", client)
    for message_type in ("SetSceneNodeClickBindingsMessage", "SceneNodeClickMessage"):
        assert message_type in script


def test_camera_is_controlled(client: str) -> None:
    folder = assets.static_dir() / "viewer"
    scripts = [(folder / name).read_text("utf-8") for name in ("inspection.js", "camera.js")]
    methods = set(re.findall(r"cameraControl\.(\w+)\(", "".join(scripts)))

    assert "cameraControl:null" in client
    assert {"setLookAt", "setFocalOffset", "rotate", "getPosition", "getTarget"} < methods
    for method in methods:
        assert re.search(rf"[}};]{method}\([\w,=!]*\)\{{", client), method
    # What is drawn is as the camera is then, and the scene as it is in this picture.
    assert re.search(
        r"updateMatrixWorld\(\).{,200}isScene===!0&&\w+\.onBeforeRender\(.{,200}projectionMatrix",
        client,
    )


def test_keys_are_heard_on_the_document(client: str) -> None:
    script = (assets.static_dir() / "viewer" / "camera.js").read_text("utf-8")
    letters = re.search(r"MOVES = new Set\(\[(.*?)\]\)", script)
    assert letters is not None
    codes = re.search(r"(\w+)=new Set\(\[(`KeyW`[^\]]*)\]\)", client)
    assert codes is not None
    arrows = {"ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight"}
    assert {*re.findall(r"\w+", codes[2])} == {*re.findall(r"\w+", letters[1])} | arrows
    assert re.search(rf"{codes[1]}\.has\(\w+\.code\).{{,400}}document\.addEventListener", client)


def test_scene_is_prepared(client: str) -> None:
    assert re.search(r"isScene===!0&&\w+\.onBeforeRender\(", client)
    # Its own are of meshes.
    assert "scene.onBeforeRender=" not in client
    for uniform in ("sectionColor", "planeOpacity"):
        assert re.search(rf"uniforms\.{uniform}\.value", client)
    script = (assets.static_dir() / "viewer" / "light.js").read_text("utf-8")
    assert "uniforms?.sectionColor?.value" in script


def test_glb_is_an_array(client: str, server: RecordedViser) -> None:
    assert re.search(r"\.parse\(new Uint8Array\((\w)\)\.buffer,", client)
    assert re.search(r"!==null&&\w===\w/4\*3;", client), "three scales of an instance"
    from hexapods.drawing.viser_internals.recorder import recorder

    data = np.arange(12, dtype=np.uint8)
    with recorder(server) as recording:
        server.scene.add_glb("/world/x", data)  # type: ignore[arg-type]
        messages, arrays = recording.take()
    (message,) = [message for message in messages if message["type"] == "GlbMessage"]
    reference = message["props"]["glb_data"]
    assert reference["dtype"] == "|u1"
    assert bytes(arrays[reference["__binary_index"]]) == data.tobytes()


def test_batched_colors_are_linear(server: RecordedViser, page: Page) -> None:
    from hexapods.drawing.viser_internals.client import batch_colors
    from hexapods.drawing.viser_internals.recorder import recorder
    from tests.running_app import wait_until
    from tests.viewer.viewer_host import draw, hosted_viewer, open_host, wait_for_node

    color = (200, 100, 50)
    corners = np.array([[0.1, -2, 0], [3, -2, 0], [3, 2, 0], [0.1, 2, 0]], np.float32)
    faces = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
    scene, camera = server.scene, server.initial_camera
    scene.set_up_direction("+y")
    scene.world_axes.visible = False
    camera.position, camera.look_at = (0.0, 0.0, 2.0), (0.0, 0.0, 0.0)
    scene.add_mesh_simple("/world/right", corners, faces, color=color)
    scene.add_batched_meshes_simple(
        "/world/left",
        corners,
        faces,
        batched_positions=np.array([[-3.1, 0.0, 0.0]]),
        batched_wxyzs=np.array([[1.0, 0.0, 0.0, 0.0]]),
        batched_colors=batch_colors(np.array([color], np.uint8)),
    )
    with hosted_viewer() as address, recorder(server) as recording:
        viewer = open_host(page, address)
        draw(page, recording.take())
        for node in ("/world/left", "/world/right"):
            wait_for_node(viewer, node)
        wait_until(lambda: all(alpha for *_, alpha in viewer.evaluate(PIXELS)))
        left, right = viewer.evaluate(PIXELS)

    # The exponent 2.2 is close to sRGB's curve; unconverted, blue would be off by some 80.
    assert left == pytest.approx(right, abs=8)
    assert right[0] > right[1] > right[2]
