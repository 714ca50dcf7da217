"""Session of one viewer: frames in order while it keeps up, one catch-up frame otherwise."""

import asyncio
from collections.abc import Awaitable, Callable
from typing import Any

import msgspec
import pytest
from starlette.websockets import WebSocket

from app.viewer.session import Counters, Session, decode_view, valid_view
from hexapods.drawing.viser_internals import stream
from hexapods.runs.race_config import MAX_LANES


class FakeBrowser:
    """Fake browser that receives one frame for each permit of a semaphore."""

    def __init__(self) -> None:
        self.received: list[Any] = []
        self.ready = asyncio.Semaphore(0)
        self.arrived = asyncio.Semaphore(0)
        self.disconnected = asyncio.Event()
        self.connected = False
        self.socket = WebSocket(
            {"type": "websocket", "headers": [], "subprotocols": []}, self._receive, self._send
        )

    async def accept(self) -> None:
        self.ready.release()
        await self.socket.accept()
        await self.arrived.acquire()
        self.received.clear()

    async def read(self, frames: int) -> None:
        for _ in range(frames):
            self.ready.release()
            await self.arrived.acquire()

    async def _receive(self) -> dict[str, Any]:
        if self.connected:
            await self.disconnected.wait()
            return {"type": "websocket.disconnect", "code": 1000}
        self.connected = True
        return {"type": "websocket.connect"}

    async def _send(self, message: Any) -> None:
        await self.ready.acquire()
        self.received.append(message.get("bytes") or message.get("code"))
        self.arrived.release()


class FakeScene:
    """Fake scene: its state is a string, and each frame appends a letter."""

    def __init__(self) -> None:
        self.frames = "A"
        self.catch_up_calls = 0
        self.is_broken = False

    def catch_up(self, session: Session) -> tuple[stream.Frame, int] | None:
        self.catch_up_calls += 1
        if self.is_broken:
            raise ZeroDivisionError
        missed = self.frames[session.version or 0 :]
        return (frame(missed), len(self.frames)) if missed else None

    def show(self, letters: str, *sessions: Session) -> None:
        for letter in letters:
            self.frames += letter
            for session in sessions:
                session.push(frame(letter), len(self.frames))


def frame(text: str) -> stream.Frame:
    return stream.Frame(text.encode(), (), (), 0.0)


def run_session(act: Callable[[Session, FakeBrowser, FakeScene], Awaitable[None]]) -> Counters:
    async def run() -> Counters:
        browser, scene, counters = FakeBrowser(), FakeScene(), Counters()
        await browser.accept()
        session = Session(browser.socket, "free", counters, scene.catch_up)
        serving = asyncio.create_task(session.run(lambda _: None))
        await act(session, browser, scene)
        browser.disconnected.set()
        await serving
        return counters

    return asyncio.run(asyncio.wait_for(run(), 30))


def test_fast_viewer_gets_each_frame() -> None:
    async def act(session: Session, browser: FakeBrowser, scene: FakeScene) -> None:
        await browser.read(1)
        for letter in "BCD":
            scene.show(letter, session)
            await browser.read(1)
        assert browser.received == [b"A", b"B", b"C", b"D"]

    counters = run_session(act)
    assert (counters.frames_sent, counters.frames_merged) == (4, 0)


@pytest.mark.parametrize("letters", ["BCDE", "BCDEFGHIJKLMNOPQRSTUVWXYZ"])
def test_frames_of_less_than_a_second_are_queued_in_order(letters: str) -> None:
    async def act(session: Session, browser: FakeBrowser, scene: FakeScene) -> None:
        await browser.read(1)
        scene.show(letters, session)
        await browser.read(len(letters))
        assert browser.received == [letter.encode() for letter in f"A{letters}"]

    assert run_session(act).frames_merged == 0


def test_slow_viewer_is_not_a_second_late_all_the_time() -> None:
    async def act(session: Session, browser: FakeBrowser, scene: FakeScene) -> None:
        await browser.read(1)

        async def stall(frames: int) -> int:
            """Stop reading for so many frames; return how many arrive after it."""
            before = len(browser.received)
            scene.show("B" * frames + "C", session)
            while not browser.received[-1].endswith(b"C"):
                await browser.read(1)
            return len(browser.received) - before

        assert await stall(60) <= 2
        assert await stall(8) <= 2
        # Once it has kept up again, a stall loses nothing again.
        for _ in range(Session.STEADY_FRAMES):
            scene.show("D", session)
            await browser.read(1)
        assert await stall(8) == 9

    run_session(act)


def test_further_frames_are_coalesced_when_the_viewer_is_ready() -> None:
    async def act(session: Session, browser: FakeBrowser, scene: FakeScene) -> None:
        await browser.read(1)
        scene.show("BCDEFGHIJ" * 100, session)
        await asyncio.sleep(0)
        catch_up_calls = scene.catch_up_calls
        scene.show("K" * 100, session)
        await asyncio.sleep(0)
        assert scene.catch_up_calls == catch_up_calls
        while not browser.received[-1].endswith(b"K"):
            await browser.read(1)
        assert b"".join(browser.received).decode() == scene.frames

    counters = run_session(act)
    assert counters.frames_sent <= 3
    assert counters.frames_merged >= 990


def test_viewer_gets_single_frames_again_after_catching_up() -> None:
    async def act(session: Session, browser: FakeBrowser, scene: FakeScene) -> None:
        await browser.read(1)
        scene.show("BCDEFGH" * 10, session)
        while not browser.received[-1].endswith(b"H"):
            await browser.read(1)
        scene.show("IJ", session)
        await browser.read(2)
        assert browser.received[-2:] == [b"I", b"J"]

    run_session(act)


def test_new_viewer_waits_for_the_first_scene() -> None:
    async def act(session: Session, browser: FakeBrowser, scene: FakeScene) -> None:
        scene.frames = ""
        await asyncio.sleep(0)
        scene.frames = "scene"
        session.wake()
        await browser.read(1)
        assert browser.received == [b"scene"]

    run_session(act)


@pytest.mark.parametrize("frames", ["", "BC", "BCDEFGHIJ"])
def test_close_does_not_wait_for_queued_frames(frames: str) -> None:
    async def act(session: Session, browser: FakeBrowser, scene: FakeScene) -> None:
        await browser.read(1)
        scene.show(frames, session)
        session.close(1012, "resync")
        await browser.read(1)
        assert browser.received == [b"A", 1012]

    run_session(act)


def test_blocked_send_is_cancelled_on_close() -> None:
    async def act(session: Session, browser: FakeBrowser, scene: FakeScene) -> None:
        await asyncio.sleep(0)
        session.close(1001, "bye")
        await session.closed(timeout_s=0.01)

    assert run_session(act).frames_sent == 0


def test_error_in_the_session_is_raised() -> None:
    async def act(session: Session, browser: FakeBrowser, scene: FakeScene) -> None:
        await browser.read(1)
        scene.is_broken = True
        scene.show("BCDEFGH" * 10, session)

    with pytest.raises(ZeroDivisionError):
        run_session(act)


def decode(message: object) -> str | None:
    return decode_view(msgspec.msgpack.encode(message))


@pytest.mark.parametrize("view", ["leader", "free", "1", str(MAX_LANES)])
def test_valid_view_is_decoded(view: str) -> None:
    assert decode({"type": "FollowMessage", "view": view}) == view
    assert valid_view(view) == view


@pytest.mark.parametrize(
    "message",
    [
        {"type": "FollowMessage", "view": str(MAX_LANES + 1)},
        {"type": "FollowMessage", "view": 1},
        {"type": "FollowMessage", "view": None},
        {"type": "FollowMessage", "view": ["leader"]},
        {"type": "FollowMessage"},
        {"type": "FollowMessage", "view": "leader", "name": "/world"},
        {"type": "FollowMessage", "view": "leader" + " " * 100},
        {"type": "RunJavascriptMessage", "view": "leader"},
        {"view": "leader"},
        "leader",
        None,
    ],
)
def test_other_messages_are_ignored(message: object) -> None:
    assert decode(message) is None


@pytest.mark.parametrize("data", [None, b"", b"\xc1", b"\x81", b"\xff" * 30, b"\0" * 100_000])
def test_invalid_bytes_are_ignored(data: bytes | None) -> None:
    assert decode_view(data) is None
