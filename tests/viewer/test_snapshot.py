"""A snapshot is equivalent to the frames applied to it, without redundant messages."""

from collections.abc import Callable, Iterator

import pytest

from app.viewer.snapshot import Snapshot
from hexapods.drawing.viser_internals import stream
from hexapods.drawing.viser_internals.server import InProcessViser
from tests.viewer.serving import Reader, Robots, array, has_message

Record = Callable[[], list[stream.Frame]]


@pytest.fixture
def record(viser_server: InProcessViser) -> Iterator[Record]:
    """Return a function that reads all frames that viser has sent so far."""
    reader = Reader(viser_server)
    frames = reader.frames_until(has_message("ReplayDoneMessage"))

    def so_far() -> list[stream.Frame]:
        viser_server.scene.set_up_direction("-y")
        mark = has_message("SetOrientationMessage", name="")
        frames.extend(reader.frames_until(mark))
        return frames

    with reader:
        yield so_far


def catch_up_frame(frames: list[stream.Frame], since: int | None = None) -> stream.Frame:
    """Return the catch-up frame for a viewer that has the first `since` frames; None for none."""
    snapshot = Snapshot()
    for frame in frames:
        snapshot.apply(frame)
    # Encoded and decoded again, so that the bytes on the wire are tested.
    return stream.parse(snapshot.pack(since).raw)


def message_types(frame: stream.Frame, name: str) -> list[str]:
    return [message["type"] for message in frame.messages if message.get("name") == name]


def test_only_the_newest_pose_is_kept(
    viser_server: InProcessViser, robots: Robots, record: Record
) -> None:
    frame_of_robot = viser_server.scene.add_frame("/world/frame")
    for place in range(10):
        robots.move_to(place)
        frame_of_robot.position = (place, 0, 0)

    all_in_one = catch_up_frame(record())

    positions = array(all_in_one, Robots.NAME, "batched_positions")
    assert positions is not None
    assert positions.tolist() == [9] * 12
    assert message_types(all_in_one, Robots.NAME).count("SceneNodeUpdateMessage") == 1
    assert message_types(all_in_one, "/world/frame").count("SetPositionMessage") == 1
    assert has_message("SetPositionMessage", name="/world/frame", position=[9.0, 0.0, 0.0])(
        all_in_one
    )


def test_creation_precedes_updates(viser_server: InProcessViser, record: Record) -> None:
    label = viser_server.scene.add_label("/world/label", "one")
    label.text = "two"
    label.visible = False

    types = message_types(catch_up_frame(record()), "/world/label")

    assert types[0] == "LabelMessage"
    assert set(types[1:]) >= {"SceneNodeUpdateMessage", "SetSceneNodeVisibilityMessage"}


def test_removed_nodes_and_gui_elements_are_dropped(
    viser_server: InProcessViser, record: Record
) -> None:
    parent = viser_server.scene.add_frame("/world/ghost")
    child = viser_server.scene.add_label("/world/ghost/name", "gone")
    child.text = "still gone"
    folder = viser_server.gui.add_folder("folder")
    with folder:
        slider = viser_server.gui.add_slider("speed", 0, 1, 0.1, 0.5)
    slider.visible = False
    before = record()[:]
    parent.remove()
    folder.remove()

    snapshot = catch_up_frame([*before, *record()])

    assert (
        message_types(snapshot, "/world/ghost")
        == message_types(snapshot, "/world/ghost/name")
        == []
    )
    assert not {"GuiFolderMessage", "GuiSliderMessage", "GuiUpdateMessage", "GuiRemoveMessage"} & {
        message["type"] for message in snapshot.messages
    }


def test_viewer_that_has_a_node_gets_its_removal(
    viser_server: InProcessViser, record: Record
) -> None:
    ghost = viser_server.scene.add_frame("/world/ghost")
    version = len(record())
    ghost.position = (1, 2, 3)
    ghost.remove()

    update = catch_up_frame(record(), version)

    assert message_types(update, "/world/ghost") == ["RemoveSceneNodeMessage"]


def test_recreated_node_follows_the_removal(viser_server: InProcessViser, record: Record) -> None:
    ghost = viser_server.scene.add_frame("/world/ghost")
    version = len(record())
    ghost.remove()
    record()
    viser_server.scene.add_label("/world/ghost", "another")

    types = message_types(catch_up_frame(record(), version), "/world/ghost")

    assert types[:2] == ["RemoveSceneNodeMessage", "LabelMessage"]


def test_replacement_drops_the_updates_of_the_old_node(
    viser_server: InProcessViser, record: Record
) -> None:
    viser_server.scene.add_label("/world/label", "old").font_screen_scale = 7
    viser_server.scene.add_label("/world/label", "new")

    snapshot = catch_up_frame(record())

    assert "font_screen_scale" not in str([m for m in snapshot.messages if "updates" in m])
    assert message_types(snapshot, "/world/label").count("LabelMessage") == 1


def test_full_snapshot_ends_with_replay_done(record: Record) -> None:
    frames = record()

    assert catch_up_frame(frames).messages[-1] == {"type": "ReplayDoneMessage"}
    assert not has_message("ReplayDoneMessage")(catch_up_frame(frames, 0))
    assert not has_message("ReplayDoneMessage")(catch_up_frame(frames[-1:]))


def test_slow_viewer_gets_only_what_it_has_missed(robots: Robots, record: Record) -> None:
    robots.move_to(1)
    version = len(record())
    robots.move_to(2)
    record()
    robots.move_to(3)
    frames = record()

    update = catch_up_frame(frames, version)

    positions = array(update, Robots.NAME, "batched_positions")
    assert positions is not None
    assert positions.tolist() == [3] * 12
    assert message_types(update, Robots.NAME) == ["SceneNodeUpdateMessage"]
    assert catch_up_frame(frames, len(frames)).messages == ()


@pytest.mark.parametrize("since", [1, 3, 7, 12])
def test_catch_up_is_equivalent_to_all_frames(
    viser_server: InProcessViser, robots: Robots, record: Record, since: int
) -> None:
    for step in range(6):
        robots.move_to(step)
        viser_server.scene.add_label("/world/label", f"step {step}").visible = False
        record()
        ghost = viser_server.scene.add_frame("/world/ghost")
        record()
        ghost.remove()
    frames = record()

    caught_up = catch_up_frame([*frames[:since], catch_up_frame(frames, since)])

    assert decoded_content(caught_up) == decoded_content(catch_up_frame(frames))


def decoded_content(frame: stream.Frame) -> list[str]:
    """Return a frame's messages with their arrays, independent of order and indices."""

    def content(message: stream.Message) -> str:
        buffers: list[memoryview] = []
        rewired = stream.remap_buffers(message, frame.buffers, buffers)
        return f"{rewired} {[bytes(buffer) for buffer in buffers]}"

    return sorted(map(content, frame.messages))


def test_extra_messages_are_appended(record: Record) -> None:
    snapshot = Snapshot()
    for frame in record():
        snapshot.apply(frame)

    assert snapshot.pack(None, [{"type": "X"}]).messages[-1] == {"type": "X"}


def test_tombstones_are_dropped_once_all_viewers_have_seen_them(
    viser_server: InProcessViser, record: Record
) -> None:
    snapshot = Snapshot()
    for number in range(3):
        ghost = viser_server.scene.add_frame(f"/world/ghost{number}")
        record()
        ghost.remove()
        record()
    for frame in record():
        snapshot.apply(frame)
    assert snapshot.tombstones == 3

    first_removal = snapshot.version - 5
    snapshot.drop_tombstones(first_removal)
    assert 0 < snapshot.tombstones < 3

    snapshot.drop_tombstones(snapshot.version)
    assert snapshot.tombstones == 0
