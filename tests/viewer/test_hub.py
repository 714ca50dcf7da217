"""The hub: relaying, slow viewers, refusals, reconnection, follow camera."""

import logging
from collections.abc import Iterator
from typing import Any

import msgspec
import numpy as np
import pytest
from viser import _messages
from websockets.exceptions import ConnectionClosed

from app.limits.client_slots import ClientSlots
from app.viewer.hub import Hub
from hexapods.drawing.track import Position
from hexapods.drawing.viser_internals import stream
from hexapods.drawing.viser_internals.server import InProcessViser
from tests.viewer.serving import (
    Robots,
    ServedHub,
    Viewer,
    array,
    has_message,
    serving,
    start_viser,
    wait_until,
)

is_complete = has_message("ReplayDoneMessage")


@pytest.fixture
def served(viser_server: InProcessViser, robots: Robots) -> Iterator[ServedHub]:
    with serving(Hub(viser_server.frames)) as served:
        yield served


def robots_at(place: float) -> Any:
    def predicate(frame: stream.Frame) -> bool:
        positions = array(frame, Robots.NAME, "batched_positions")
        return positions is not None and bool(np.all(positions == place))

    return predicate


def follow(viewer: Viewer, view: str) -> None:
    viewer.socket.send(msgspec.msgpack.encode({"type": "FollowMessage", "view": view}))


def close_code(viewer: Viewer) -> tuple[int, str]:
    with pytest.raises(ConnectionClosed) as closed:
        viewer.frames_until(lambda _: False)
    assert closed.value.rcvd is not None
    return closed.value.rcvd.code, closed.value.rcvd.reason


def test_late_joiner_gets_the_whole_scene_in_one_frame(served: ServedHub, robots: Robots) -> None:
    with served.watch() as early:
        early.frame()
        robots.move_to(5)
        early.frames_until(robots_at(5))
        with served.watch() as late:
            frame = late.frame()

    assert is_complete(frame)
    assert has_message("BatchedMeshesMessage", name=Robots.NAME)(frame)
    assert robots_at(5)(frame)


def test_all_viewers_get_the_same_bytes(served: ServedHub, robots: Robots) -> None:
    with served.watch() as first, served.watch() as second:
        first.frame()
        second.frame()
        for place in range(1, 20):
            robots.move_to(place)
            frames = first.frames_until(robots_at(place))
            assert [frame.raw for frame in frames] == [
                frame.raw for frame in second.frames_until(robots_at(place))
            ]


def test_viewers_are_counted(viser_server: InProcessViser) -> None:
    counts: list[int] = []
    hub = Hub(viser_server.frames, on_viewers_changed=counts.append)
    with serving(hub) as served:
        with served.watch() as first, served.watch() as second:
            first.frame()
            second.frame()
        wait_until(lambda: hub.counters.viewers == 0)

    assert counts == [1, 2, 1, 0]
    assert hub.counters.frames_sent >= 2


def test_slow_viewer_gets_coalesced_frames_and_does_not_slow_others(
    served: ServedHub, robots: Robots
) -> None:
    counters = served.hub.counters
    with served.watch() as quick, served.watch_slowly() as slow:
        quick.frame()
        place = 0
        quick_frames = []
        while counters.frames_merged < 50:
            place += 1
            robots.move_to(place)
            quick_frames += quick.frames_until(robots_at(place))
        caught_up = slow.frames_until(robots_at(place))

        # The quick viewer gets each frame, the slow one fewer, the newest last.
        assert len(quick_frames) >= place
        assert len(caught_up) < len(quick_frames)
        robots.move_to(-1)
        slow.frames_until(robots_at(-1))
        assert counters.viewers == 2
        assert counters.resyncs == 0


def test_viewer_without_pongs_is_disconnected(viser_server: InProcessViser, robots: Robots) -> None:
    hub = Hub(viser_server.frames)
    with (
        # A generous timeout, since the responsive viewer may be slow on a busy machine.
        serving(hub, ws_ping_interval=0.2, ws_ping_timeout=3.0) as served,
        served.watch() as quick,
        served.watch_slowly(),
    ):
        quick.frame()
        wait_until(lambda: hub.counters.viewers == 2)
        place = 0
        while hub.counters.viewers == 2:
            place += 1
            robots.move_to(place)
            quick.frames_until(robots_at(place))

        robots.move_to(-1)
        quick.frames_until(robots_at(-1))
        assert hub.counters.viewers == 1


def test_stalled_viewers_do_not_delay_shutdown(
    viser_server: InProcessViser, robots: Robots
) -> None:
    hub = Hub(viser_server.frames)
    with serving(hub) as served:
        slow = served.watch_slowly()
        quick = served.watch()
        quick.frame()
        place = 0
        while hub.counters.frames_merged == 0:
            place += 1
            robots.move_to(place)
            quick.frames_until(robots_at(place))

    assert hub.counters.viewers == 0
    with pytest.raises(ConnectionClosed):
        quick.frame()
    slow.socket.close()


def test_messages_of_browsers_do_not_reach_viser(
    viser_server: InProcessViser, served: ServedHub
) -> None:
    connected_clients: list[object] = []
    viser_server.on_client_connect(connected_clients.append)
    box = viser_server.gui.add_checkbox("box", initial_value=False)
    with served.watch() as viewer:
        viewer.frame()
        for message in (
            {"type": "GuiUpdateMessage", "uuid": box._impl.uuid, "updates": {"value": True}},
            {"type": "ShareUrlRequest"},
            {"type": "RunJavascriptMessage", "source": "1"},
        ):
            viewer.socket.send(msgspec.msgpack.encode(message))
        viewer.socket.send(b"\xc1 not msgpack")
        viewer.socket.send("text")
        # The pong arrives after all earlier messages were processed.
        viewer.socket.ping().wait(10)

        box.label = "still there"
        viewer.frames_until(has_message("GuiUpdateMessage", updates={"label": "still there"}))

    assert box.value is False
    assert connected_clients == []


def test_large_message_closes_the_connection(served: ServedHub) -> None:
    with served.watch() as viewer:
        viewer.frame()
        viewer.socket.send(bytes(100_000))

        assert close_code(viewer)[0] == 1009
    wait_until(lambda: served.hub.counters.viewers == 0)


@pytest.mark.parametrize("protocol", ["viser-v0.0.1", "chat"])
def test_wrong_subprotocol_is_refused_with_reload(served: ServedHub, protocol: str) -> None:
    with Viewer(f"ws://{served.host}/viewer/", protocol) as viewer:
        assert close_code(viewer) == (1002, "reload")


def test_viewer_over_the_limit_is_refused_until_one_leaves(viser_server: InProcessViser) -> None:
    with serving(Hub(viser_server.frames, slots=ClientSlots(1, 10))) as served:
        with served.watch() as first:
            first.frame()
            with served.watch() as second:
                assert close_code(second) == (1013, "full")
        wait_until(lambda: served.hub.counters.viewers == 0)
        with served.watch() as third:
            assert is_complete(third.frame())


def test_script_messages_are_not_relayed(viser_server: InProcessViser, served: ServedHub) -> None:
    with served.watch() as early:
        early.frame()
        with viser_server.atomic():
            script = _messages.RunJavascriptMessage("document.title = 'hacked'")
            viser_server._websock_server.queue_message(script)
            viser_server.scene.add_label("/world/beside", "it")
        live = early.frames_until(has_message("LabelMessage"))
        with served.watch() as late:
            snapshot = late.frame()

    assert not any(has_message("RunJavascriptMessage")(frame) for frame in [*live, snapshot])
    assert has_message("LabelMessage", name="/world/beside")(snapshot)


def test_viewers_reconnect_after_a_restart_of_viser(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.WARNING, "app.viewer.hub")
    viser_server = start_viser()
    hub = Hub(viser_server.frames)
    with serving(hub) as served, served.watch() as before:
        assert is_complete(before.frame())
        viser_server.stop()
        with served.watch() as meanwhile:
            restarted = start_viser()
            hub.upstream = restarted.frames
            restarted.scene.add_label("/world/again", "here")

            assert close_code(before) == (1012, "resync")
            frames = [meanwhile.frame()]
            if not has_message("LabelMessage")(frames[0]):
                frames += meanwhile.frames_until(has_message("LabelMessage"))
            assert served.hub.counters.resyncs == 1
            with served.watch() as after:
                assert has_message("LabelMessage", name="/world/again")(after.frame())
        restarted.stop()
    assert is_complete(frames[0])
    assert "lost the connection to viser" in caplog.text


def test_viewers_wait_until_viser_is_connected() -> None:
    hub = Hub()
    with serving(hub) as served, served.watch() as viewer:
        viser_server = start_viser()
        hub.upstream = viser_server.frames
        assert is_complete(viewer.frame())
        viser_server.stop()


class FollowPositions:
    """Fake of the positions of the robots that viewers follow."""

    def __init__(self) -> None:
        self.positions: dict[str, Position] = {"leader": (3.0, 1.0, 0.5), "2": (1.0, 0, 0)}

    def __call__(self, view: str) -> Position | None:
        return self.positions.get(view)


@pytest.fixture
def follow_positions() -> FollowPositions:
    return FollowPositions()


@pytest.fixture
def served_with_follow(
    viser_server: InProcessViser, robots: Robots, follow_positions: FollowPositions
) -> Iterator[ServedHub]:
    with serving(Hub(viser_server.frames, follow_position=follow_positions)) as served:
        yield served


def centred_on(frame: stream.Frame) -> tuple[float, float] | None:
    """Return the position on which a frame centres the world, None if it does not."""
    [*_, position] = [None] + [
        message["position"]
        for message in frame.messages
        if message["type"] == "SetPositionMessage" and message["name"] == "/world"
    ]
    return None if position is None else (-position[0], -position[1])


def test_each_viewer_is_centred_on_its_own_view(
    served_with_follow: ServedHub, robots: Robots
) -> None:
    views = {"leader": (3, 1), "2": (1, 0), "7": None, "free": None, None: None, "bogus": None}
    viewers = {view: served_with_follow.watch(view) for view in views}
    for viewer in viewers.values():
        viewer.frame()

    robots.move_to(4)
    frames = {view: viewer.frames_until(robots_at(4))[-1] for view, viewer in viewers.items()}

    assert {view: centred_on(frame) for view, frame in frames.items()} == views
    assert frames["free"].raw == frames["7"].raw == frames[None].raw
    assert frames["leader"].timestamp_s == frames["free"].timestamp_s
    for viewer in viewers.values():
        viewer.socket.close()


def test_first_frame_is_centred(served_with_follow: ServedHub) -> None:
    with served_with_follow.watch("leader") as viewer:
        frame = viewer.frame()

    assert is_complete(frame)
    assert centred_on(frame) == (3, 1)


def test_view_can_be_changed_without_a_new_connection(
    served_with_follow: ServedHub, robots: Robots, follow_positions: FollowPositions
) -> None:
    def choose(view: str) -> None:
        follow(viewer, view)

    with served_with_follow.watch("free") as viewer:
        viewer.frame()
        choose("2")
        assert centred_on(viewer.frame()) == (1, 0)

        follow_positions.positions["2"] = (1.5, 0.25, 0)
        robots.move_to(1)
        assert centred_on(viewer.frames_until(robots_at(1))[-1]) == (1.5, 0.25)

        choose("nonsense")
        choose("free")
        viewer.socket.ping().wait(10)
        robots.move_to(2)
        assert centred_on(viewer.frames_until(robots_at(2))[-1]) is None


def test_error_while_relaying_makes_viewers_reconnect(
    served_with_follow: ServedHub,
    robots: Robots,
    follow_positions: FollowPositions,
    caplog: pytest.LogCaptureFixture,
) -> None:
    with served_with_follow.watch("leader") as viewer:
        viewer.frame()
        follow_positions.positions["leader"] = ("far",)  # type: ignore[assignment]
        robots.move_to(1)
        wait_until(lambda: "relaying failed" in caplog.text)
        follow_positions.positions["leader"] = (1.0, 1.0, 0.0)

        assert close_code(viewer)[0] == 1012
    with served_with_follow.watch("leader") as viewer:
        assert robots_at(1)(viewer.frame())


def test_a_page_that_plays_a_run_by_itself_gets_no_frames(
    served: ServedHub, robots: Robots
) -> None:
    with served.watch() as everybody, served.watch("elsewhere") as replaying:
        everybody.frames_until(is_complete)
        assert [message["type"] for message in replaying.frame().messages] == ["ReplayDoneMessage"]
        robots.move_to(7)
        everybody.frames_until(robots_at(7))
        follow(replaying, "free")
        (back,) = replaying.frames_until(is_complete)
        assert robots_at(7)(back), "the whole scene at once, and nothing before it"

        follow(replaying, "elsewhere")
        follow(replaying, "free")
        assert replaying.frames_until(is_complete)
