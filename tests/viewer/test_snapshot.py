"""A snapshot says the same as all the frames it was made of, and no more."""

from collections.abc import Callable, Iterator

import pytest

from app.viewer import wire
from app.viewer.in_process import InProcessViser
from app.viewer.snapshot import Snapshot
from tests.viewer.serving import Reader, Robots, array, says

Record = Callable[[], list[wire.Frame]]


@pytest.fixture
def record(stage: InProcessViser) -> Iterator[Record]:
    """Every frame that viser has sent since the test began, up to now."""
    reader = Reader(stage)
    frames = reader.frames_until(says("ReplayDoneMessage"))

    def so_far() -> list[wire.Frame]:
        stage.scene.set_up_direction("-y")
        mark = says("SetOrientationMessage", name="")
        frames.extend(reader.frames_until(mark))
        return frames

    with reader:
        yield so_far


def folded(frames: list[wire.Frame], since: int | None = None) -> wire.Frame:
    """What a viewer needs who has that many of these frames; None for a newcomer."""
    snapshot = Snapshot()
    for frame in frames:
        snapshot.apply(frame)
    # What goes over the wire, rather than what we believe it to be.
    return wire.parse(snapshot.pack(since).raw)


def about(frame: wire.Frame, name: str) -> list[str]:
    return [message["type"] for message in frame.messages if message.get("name") == name]


def test_only_the_newest_pose_is_kept(
    stage: InProcessViser, robots: Robots, record: Record
) -> None:
    frame_of_robot = stage.scene.add_frame("/world/frame")
    for place in range(10):
        robots.stand_at(place)
        frame_of_robot.position = (place, 0, 0)

    all_in_one = folded(record())

    positions = array(all_in_one, Robots.NAME, "batched_positions")
    assert positions is not None
    assert positions.tolist() == [9] * 12
    assert about(all_in_one, Robots.NAME).count("SceneNodeUpdateMessage") == 1
    assert about(all_in_one, "/world/frame").count("SetPositionMessage") == 1
    assert says("SetPositionMessage", name="/world/frame", position=[9.0, 0.0, 0.0])(all_in_one)


def test_a_thing_is_made_before_it_is_changed(stage: InProcessViser, record: Record) -> None:
    label = stage.scene.add_label("/world/plate", "one")
    label.text = "two"
    label.visible = False

    types = about(folded(record()), "/world/plate")

    assert types[0] == "LabelMessage"
    assert set(types[1:]) >= {"SceneNodeUpdateMessage", "SetSceneNodeVisibilityMessage"}


def test_what_is_gone_is_forgotten(stage: InProcessViser, record: Record) -> None:
    parent = stage.scene.add_frame("/world/ghost")
    child = stage.scene.add_label("/world/ghost/name", "gone")
    child.text = "still gone"
    folder = stage.gui.add_folder("folder")
    with folder:
        slider = stage.gui.add_slider("speed", 0, 1, 0.1, 0.5)
    slider.visible = False
    before = record()[:]
    parent.remove()
    folder.remove()

    now = folded([*before, *record()])

    assert about(now, "/world/ghost") == about(now, "/world/ghost/name") == []
    assert not {"GuiFolderMessage", "GuiSliderMessage", "GuiUpdateMessage", "GuiRemoveMessage"} & {
        message["type"] for message in now.messages
    }


def test_who_saw_it_is_told_that_it_is_gone(stage: InProcessViser, record: Record) -> None:
    ghost = stage.scene.add_frame("/world/ghost")
    seen = len(record())
    ghost.position = (1, 2, 3)
    ghost.remove()

    news = folded(record(), seen)

    assert about(news, "/world/ghost") == ["RemoveSceneNodeMessage"]


def test_a_successor_comes_after_the_removal(stage: InProcessViser, record: Record) -> None:
    ghost = stage.scene.add_frame("/world/ghost")
    seen = len(record())
    ghost.remove()
    record()
    stage.scene.add_label("/world/ghost", "another")

    types = about(folded(record(), seen), "/world/ghost")

    assert types[:2] == ["RemoveSceneNodeMessage", "LabelMessage"]


def test_a_replacement_takes_the_old_ones_changes_with_it(
    stage: InProcessViser, record: Record
) -> None:
    stage.scene.add_label("/world/plate", "old").font_screen_scale = 7
    stage.scene.add_label("/world/plate", "new")

    now = folded(record())

    assert "font_screen_scale" not in str([m for m in now.messages if "updates" in m])
    assert about(now, "/world/plate").count("LabelMessage") == 1


def test_it_ends_with_the_word_that_viser_s_client_waits_for(record: Record) -> None:
    frames = record()

    assert folded(frames).messages[-1] == {"type": "ReplayDoneMessage"}
    assert not says("ReplayDoneMessage")(folded(frames, 0))
    assert not says("ReplayDoneMessage")(folded(frames[-1:]))


def test_a_laggard_gets_what_it_has_missed_and_no_more(robots: Robots, record: Record) -> None:
    robots.stand_at(1)
    seen = len(record())
    robots.stand_at(2)
    record()
    robots.stand_at(3)
    frames = record()

    news = folded(frames, seen)

    positions = array(news, Robots.NAME, "batched_positions")
    assert positions is not None
    assert positions.tolist() == [3] * 12
    assert about(news, Robots.NAME) == ["SceneNodeUpdateMessage"]
    assert folded(frames, len(frames)).messages == ()


@pytest.mark.parametrize("since", [1, 3, 7, 12])
def test_catching_up_is_as_good_as_having_seen_all(
    stage: InProcessViser, robots: Robots, record: Record, since: int
) -> None:
    for step in range(6):
        robots.stand_at(step)
        stage.scene.add_label("/world/plate", f"step {step}").visible = False
        record()
        ghost = stage.scene.add_frame("/world/ghost")
        record()
        ghost.remove()
    frames = record()

    caught_up = folded([*frames[:since], folded(frames, since)])

    assert meaning(caught_up) == meaning(folded(frames))


def meaning(frame: wire.Frame) -> list[str]:
    """What a frame says, array by array, whatever the order."""

    def own(message: wire.Message) -> str:
        buffers: list[memoryview] = []
        rewired = wire.rewire(message, frame.buffers, buffers)
        return f"{rewired} {[bytes(buffer) for buffer in buffers]}"

    return sorted(map(own, frame.messages))


def test_more_can_be_said_at_the_end(record: Record) -> None:
    snapshot = Snapshot()
    for frame in record():
        snapshot.apply(frame)

    assert snapshot.pack(None, [{"type": "X"}]).messages[-1] == {"type": "X"}


def test_what_was_gone_for_all_viewers_is_forgotten(stage: InProcessViser, record: Record) -> None:
    snapshot = Snapshot()
    for number in range(3):
        ghost = stage.scene.add_frame(f"/world/ghost{number}")
        record()
        ghost.remove()
        record()
    for frame in record():
        snapshot.apply(frame)
    assert snapshot.removals == 3

    first_gone = snapshot.version - 5
    snapshot.forget_removals(first_gone)
    assert 0 < snapshot.removals < 3

    snapshot.forget_removals(snapshot.version)
    assert snapshot.removals == 0
