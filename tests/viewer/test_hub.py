"""Every browser sees what viser draws; none can say anything to it."""

import logging
from collections.abc import Iterator
from typing import Any

import msgspec
import numpy as np
import pytest
from viser import _messages
from websockets.exceptions import ConnectionClosed, InvalidStatus

from app.viewer import follow, wire
from app.viewer.hub import Hub
from app.viewer.in_process import InProcessViser
from tests.viewer.serving import (
    Address,
    Robots,
    Viewer,
    array,
    eventually,
    says,
    serving,
    start_viser,
)

FULL = says("ReplayDoneMessage")


@pytest.fixture
def address(stage: InProcessViser, robots: Robots) -> Iterator[Address]:
    with serving(Hub(stage.frames)) as address:
        yield address


def stands_at(place: float) -> Any:
    def holds(frame: wire.Frame) -> bool:
        places = array(frame, Robots.NAME, "batched_positions")
        return places is not None and bool(np.all(places == place))

    return holds


def close_code(viewer: Viewer) -> tuple[int, str]:
    with pytest.raises(ConnectionClosed) as closed:
        viewer.frames_until(lambda _: False)
    assert closed.value.rcvd is not None
    return closed.value.rcvd.code, closed.value.rcvd.reason


def test_a_late_joiner_gets_everything_in_one_frame(address: Address, robots: Robots) -> None:
    with address.watch() as early:
        early.frame()
        robots.stand_at(5)
        early.frames_until(stands_at(5))
        with address.watch() as late:
            frame = late.frame()

    assert FULL(frame)
    assert says("BatchedMeshesMessage", name=Robots.NAME)(frame)
    assert stands_at(5)(frame)


def test_all_get_the_same_bytes(address: Address, robots: Robots) -> None:
    with address.watch() as one, address.watch() as other:
        one.frame()
        other.frame()
        for place in range(1, 20):
            robots.stand_at(place)
            frames = one.frames_until(stands_at(place))
            assert [frame.raw for frame in frames] == [
                frame.raw for frame in other.frames_until(stands_at(place))
            ]


def test_viewers_are_counted(stage: InProcessViser) -> None:
    counts: list[int] = []
    hub = Hub(stage.frames, on_viewers_changed=counts.append)
    with serving(hub) as address:
        with address.watch() as one, address.watch() as other:
            one.frame()
            other.frame()
        eventually(lambda: hub.counters.viewers == 0)

    assert counts == [1, 2, 1, 0]
    assert hub.counters.frames_sent >= 2


def test_who_does_not_read_is_merged_and_harms_nobody(address: Address, robots: Robots) -> None:
    counters = address.hub.counters
    with address.watch() as quick, address.watch_slowly() as slow:
        quick.frame()
        place = 0
        seen = []
        while counters.frames_merged < 50:
            place += 1
            robots.stand_at(place)
            seen += quick.frames_until(stands_at(place))
        caught_up = slow.frames_until(stands_at(place))

        # Each frame one by one for the one, fewer but never an old one last for the other.
        assert len(seen) >= place
        assert len(caught_up) < len(seen)
        robots.stand_at(-1)
        slow.frames_until(stands_at(-1))
        assert counters.viewers == 2
        assert counters.resyncs == 0


def test_who_answers_no_ping_is_let_go(stage: InProcessViser, robots: Robots) -> None:
    hub = Hub(stage.frames)
    with (
        # The one who answers may be slow to, beside other work on the machine.
        serving(hub, ws_ping_interval=0.2, ws_ping_timeout=3.0) as address,
        address.watch() as quick,
        address.watch_slowly(),
    ):
        quick.frame()
        eventually(lambda: hub.counters.viewers == 2)
        place = 0
        while hub.counters.viewers == 2:
            place += 1
            robots.stand_at(place)
            quick.frames_until(stands_at(place))

        robots.stand_at(-1)
        quick.frames_until(stands_at(-1))
        assert hub.counters.viewers == 1


def test_stalled_viewers_do_not_hold_up_the_end(stage: InProcessViser, robots: Robots) -> None:
    hub = Hub(stage.frames)
    with serving(hub) as address:
        slow = address.watch_slowly()
        quick = address.watch()
        quick.frame()
        place = 0
        while hub.counters.frames_merged == 0:
            place += 1
            robots.stand_at(place)
            quick.frames_until(stands_at(place))

    assert hub.counters.viewers == 0
    with pytest.raises(ConnectionClosed):
        quick.frame()
    slow.socket.close()


def test_nobody_is_heard_by_viser(stage: InProcessViser, address: Address) -> None:
    heard: list[object] = []
    stage.on_client_connect(heard.append)
    box = stage.gui.add_checkbox("box", initial_value=False)
    with address.watch() as viewer:
        viewer.frame()
        for message in (
            {"type": "GuiUpdateMessage", "uuid": box._impl.uuid, "updates": {"value": True}},
            {"type": "ShareUrlRequest"},
            {"type": "RunJavascriptMessage", "source": "1"},
        ):
            viewer.socket.send(msgspec.msgpack.encode(message))
        viewer.socket.send(b"\xc1 not msgpack")
        viewer.socket.send("text")
        # Answered after all that was said before it.
        viewer.socket.ping().wait(10)

        box.label = "still there"
        viewer.frames_until(says("GuiUpdateMessage", updates={"label": "still there"}))

    assert box.value is False
    assert heard == []


def test_something_large_is_not_even_read(address: Address) -> None:
    with address.watch() as viewer:
        viewer.frame()
        viewer.socket.send(bytes(100_000))

        assert close_code(viewer)[0] == 1009
    eventually(lambda: address.hub.counters.viewers == 0)


@pytest.mark.parametrize("protocol", ["viser-v0.0.1", "chat"])
def test_another_version_is_told_to_reload(address: Address, protocol: str) -> None:
    with Viewer(f"ws://{address.host}/viewer/", protocol) as viewer:
        assert close_code(viewer) == (1002, "reload")


def test_a_full_house_says_so_and_has_room_again(stage: InProcessViser) -> None:
    with serving(Hub(stage.frames, max_viewers=1)) as address:
        with address.watch() as first:
            first.frame()
            with address.watch() as second:
                assert close_code(second) == (1013, "full")
        eventually(lambda: address.hub.counters.viewers == 0)
        with address.watch() as third:
            assert FULL(third.frame())


@pytest.mark.parametrize("origin", ["http://evil.example", "http://127.0.0.1", "null"])
def test_foreign_pages_get_nothing(address: Address, origin: str) -> None:
    with pytest.raises(InvalidStatus) as refused:
        address.watch(origin=origin)

    assert refused.value.response.status_code == 403


def test_our_own_page_and_a_named_one_get_in(stage: InProcessViser) -> None:
    hub = Hub(stage.frames, allowed_origins=["https://race.example"])
    with serving(hub) as address:
        for origin in (f"http://{address.host}", "https://race.example"):
            with address.watch(origin=origin) as viewer:
                assert FULL(viewer.frame())


def test_scripts_reach_no_browser(stage: InProcessViser, address: Address) -> None:
    with address.watch() as early:
        early.frame()
        with stage.atomic():
            script = _messages.RunJavascriptMessage("document.title = 'hacked'")
            stage._websock_server.queue_message(script)
            stage.scene.add_label("/world/beside", "it")
        live = early.frames_until(says("LabelMessage"))
        with address.watch() as late:
            snapshot = late.frame()

    assert not any(says("RunJavascriptMessage")(frame) for frame in [*live, snapshot])
    assert says("LabelMessage", name="/world/beside")(snapshot)


def test_viser_s_return_is_seen_by_all(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.WARNING, "app.viewer.hub")
    stage = start_viser()
    hub = Hub(stage.frames)
    with serving(hub) as address, address.watch() as before:
        assert FULL(before.frame())
        stage.stop()
        with address.watch() as meanwhile:
            again = start_viser()
            hub.upstream = again.frames
            again.scene.add_label("/world/again", "here")

            assert close_code(before) == (1012, "resync")
            everything = [meanwhile.frame()]
            if not says("LabelMessage")(everything[0]):
                everything += meanwhile.frames_until(says("LabelMessage"))
            assert address.hub.counters.resyncs == 1
            with address.watch() as after:
                assert says("LabelMessage", name="/world/again")(after.frame())
        again.stop()
    assert FULL(everything[0])
    assert "lost viser" in caplog.text


def test_viewers_wait_for_viser() -> None:
    hub = Hub()
    with serving(hub) as address, address.watch() as viewer:
        stage = start_viser()
        hub.upstream = stage.frames
        assert FULL(viewer.frame())
        stage.stop()


class Race:
    """Where the robots are that viewers follow."""

    def __init__(self) -> None:
        self.positions: dict[str, follow.Position] = {"leader": (3.0, 1.0, 0.5), "2": (1.0, 0, 0)}

    def __call__(self, view: str) -> follow.Position | None:
        return self.positions.get(view)


@pytest.fixture
def race() -> Race:
    return Race()


@pytest.fixture
def followed(stage: InProcessViser, robots: Robots, race: Race) -> Iterator[Address]:
    with serving(Hub(stage.frames, follow_position=race)) as address:
        yield address


def centred_on(frame: wire.Frame) -> tuple[float, float] | None:
    """Where the followed robot is, to which the frame moves the world."""
    [*_, position] = [None] + [
        message["position"]
        for message in frame.messages
        if message["type"] == "SetPositionMessage" and message["name"] == "/world"
    ]
    return None if position is None else (-position[0], -position[1])


def test_each_sees_what_it_follows_and_no_other(followed: Address, robots: Robots) -> None:
    views = {"leader": (3, 1), "2": (1, 0), "7": None, "free": None, None: None, "bogus": None}
    viewers = {view: followed.watch(view) for view in views}
    for viewer in viewers.values():
        viewer.frame()

    robots.stand_at(4)
    frames = {view: viewer.frames_until(stands_at(4))[-1] for view, viewer in viewers.items()}

    assert {view: centred_on(frame) for view, frame in frames.items()} == views
    assert frames["free"].raw == frames["7"].raw == frames[None].raw
    assert frames["leader"].timestamp_s == frames["free"].timestamp_s
    for viewer in viewers.values():
        viewer.socket.close()


def test_a_newcomer_sees_the_robot_in_the_middle_at_once(followed: Address) -> None:
    with followed.watch("leader") as viewer:
        frame = viewer.frame()

    assert FULL(frame)
    assert centred_on(frame) == (3, 1)


def test_another_view_needs_no_new_connection(
    followed: Address, robots: Robots, race: Race
) -> None:
    def choose(view: str) -> None:
        viewer.socket.send(msgspec.msgpack.encode({"type": "FollowMessage", "view": view}))

    with followed.watch("free") as viewer:
        viewer.frame()
        choose("2")
        assert centred_on(viewer.frame()) == (1, 0)

        race.positions["2"] = (1.5, 0.25, 0)
        robots.stand_at(1)
        assert centred_on(viewer.frames_until(stands_at(1))[-1]) == (1.5, 0.25)

        choose("nonsense")
        choose("free")
        viewer.socket.ping().wait(10)
        robots.stand_at(2)
        assert centred_on(viewer.frames_until(stands_at(2))[-1]) is None


def test_a_fault_of_ours_does_not_end_the_show(
    followed: Address, robots: Robots, race: Race, caplog: pytest.LogCaptureFixture
) -> None:
    with followed.watch("leader") as viewer:
        viewer.frame()
        race.positions["leader"] = ("far",)  # type: ignore[assignment]
        robots.stand_at(1)
        eventually(lambda: "relaying failed" in caplog.text)
        race.positions["leader"] = (1.0, 1.0, 0.0)

        assert close_code(viewer)[0] == 1012
    with followed.watch("leader") as viewer:
        assert stands_at(1)(viewer.frame())
