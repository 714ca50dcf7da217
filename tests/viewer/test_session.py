"""One viewer's frames: in order while it keeps up, all it has missed in one when it does not."""

import asyncio
from collections.abc import Awaitable, Callable
from typing import Any

import pytest
from starlette.websockets import WebSocket

from app.viewer import wire
from app.viewer.session import Counters, Session


class Browser:
    """Takes what it is sent when it is told to, one frame after another."""

    def __init__(self) -> None:
        self.got: list[Any] = []
        self.ready = asyncio.Semaphore(0)
        self.arrived = asyncio.Semaphore(0)
        self.leaves = asyncio.Event()
        self.connected = False
        self.socket = WebSocket(
            {"type": "websocket", "headers": [], "subprotocols": []}, self._receive, self._send
        )

    async def accept(self) -> None:
        self.ready.release()
        await self.socket.accept()
        await self.arrived.acquire()
        self.got.clear()

    async def reads(self, frames: int) -> None:
        for _ in range(frames):
            self.ready.release()
            await self.arrived.acquire()

    async def _receive(self) -> dict[str, Any]:
        if self.connected:
            await self.leaves.wait()
            return {"type": "websocket.disconnect", "code": 1000}
        self.connected = True
        return {"type": "websocket.connect"}

    async def _send(self, message: Any) -> None:
        await self.ready.acquire()
        self.got.append(message.get("bytes") or message.get("code"))
        self.arrived.release()


class Scene:
    """What there is to catch up with: frame by frame, a letter each."""

    def __init__(self) -> None:
        self.frames = "A"
        self.asked = 0

    def missed_by(self, session: Session) -> tuple[wire.Frame, int] | None:
        self.asked += 1
        missed = self.frames[session.version or 0 :]
        return (frame(missed), len(self.frames)) if missed else None

    def show(self, letters: str, *sessions: Session) -> None:
        for letter in letters:
            self.frames += letter
            for session in sessions:
                session.push(frame(letter), len(self.frames))


def frame(text: str) -> wire.Frame:
    return wire.Frame(text.encode(), (), (), 0.0)


def in_a_session(act: Callable[[Session, Browser, Scene], Awaitable[None]]) -> Counters:
    async def run() -> Counters:
        browser, scene, counters = Browser(), Scene(), Counters()
        await browser.accept()
        session = Session(browser.socket, "free", counters, scene.missed_by)
        serving = asyncio.create_task(session.run(lambda _: None))
        await act(session, browser, scene)
        browser.leaves.set()
        await serving
        return counters

    return asyncio.run(asyncio.wait_for(run(), 30))


def test_who_keeps_up_gets_frame_by_frame() -> None:
    async def act(session: Session, browser: Browser, scene: Scene) -> None:
        await browser.reads(1)
        for letter in "BCD":
            scene.show(letter, session)
            await browser.reads(1)
        assert browser.got == [b"A", b"B", b"C", b"D"]

    counters = in_a_session(act)
    assert (counters.frames_sent, counters.frames_merged) == (4, 0)


def test_a_few_frames_wait_in_order() -> None:
    async def act(session: Session, browser: Browser, scene: Scene) -> None:
        await browser.reads(1)
        scene.show("BCDE", session)
        await browser.reads(4)
        assert browser.got == [b"A", b"B", b"C", b"D", b"E"]

    assert in_a_session(act).frames_merged == 0


def test_more_come_in_one_which_is_made_only_when_it_can_go() -> None:
    async def act(session: Session, browser: Browser, scene: Scene) -> None:
        await browser.reads(1)
        scene.show("BCDEFGHIJ" * 100, session)
        await asyncio.sleep(0)
        asked = scene.asked
        scene.show("K" * 100, session)
        await asyncio.sleep(0)
        assert scene.asked == asked
        while not browser.got[-1].endswith(b"K"):
            await browser.reads(1)
        assert b"".join(browser.got).decode() == scene.frames

    counters = in_a_session(act)
    assert counters.frames_sent <= 3
    assert counters.frames_merged >= 990


def test_who_caught_up_goes_on_frame_by_frame() -> None:
    async def act(session: Session, browser: Browser, scene: Scene) -> None:
        await browser.reads(1)
        scene.show("BCDEFGH", session)
        while not browser.got[-1].endswith(b"H"):
            await browser.reads(1)
        scene.show("IJ", session)
        await browser.reads(2)
        assert browser.got[-2:] == [b"I", b"J"]

    in_a_session(act)


def test_a_newcomer_waits_until_there_is_something() -> None:
    async def act(session: Session, browser: Browser, scene: Scene) -> None:
        scene.frames = ""
        await asyncio.sleep(0)
        scene.frames = "scene"
        session.wake()
        await browser.reads(1)
        assert browser.got == [b"scene"]

    in_a_session(act)


@pytest.mark.parametrize("frames", ["", "BC", "BCDEFGHIJ"])
def test_closing_does_not_wait_for_frames(frames: str) -> None:
    async def act(session: Session, browser: Browser, scene: Scene) -> None:
        await browser.reads(1)
        scene.show(frames, session)
        session.close(1012, "resync")
        await browser.reads(1)
        assert browser.got == [b"A", 1012]

    in_a_session(act)


def test_a_send_that_never_ends_is_given_up() -> None:
    async def act(session: Session, browser: Browser, scene: Scene) -> None:
        await asyncio.sleep(0)
        session.close(1001, "bye")
        await session.closed(timeout_s=0.01)

    assert in_a_session(act).frames_sent == 0


def test_a_fault_is_not_swallowed() -> None:
    async def act(session: Session, browser: Browser, scene: Scene) -> None:
        await browser.reads(1)
        session._catch_up = lambda _: 1 / 0  # type: ignore[assignment, return-value]
        scene.show("BCDEFGH", session)

    with pytest.raises(ZeroDivisionError):
        in_a_session(act)
