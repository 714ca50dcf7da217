"""The stages of rooms: each open room has one of its own, at its path."""

import asyncio
import contextlib
from collections.abc import Callable, MutableSequence

from app.features.classroom.access import PAGES
from app.features.classroom.room import Room
from app.viewer.shared_stage import SharedStage
from hexapods.domain.errors import HexapodError


class RoomStages:
    """Opens and closes the stages of rooms, on the event loop."""

    def __init__(
        self, stages: MutableSequence[SharedStage], make: Callable[[str], SharedStage]
    ) -> None:
        """Begin with no stage of a room; `open` adds one.

        Args:
            stages: all stages of the server, to which the stages of rooms are added.
            make: creates a stage with a path.
        """
        self._stages, self._make = stages, make
        self._lock = asyncio.Lock()

    async def open(self, room: Room) -> None:
        """Open the stage of a room, unless it is open; its run in the spotlight is on it."""
        async with self._lock:
            if self.of(room.code) is not None:
                return
            shared = self._make(path_of_room(room.code))
            if room.spotlight is not None:
                with contextlib.suppress(HexapodError):  # deleted, or damaged
                    await asyncio.to_thread(shared.stage.set, run_id=room.spotlight)
            await shared.__aenter__()
            self._stages.append(shared)

    def publish(self, room: Room) -> None:
        """Publish a `room` event on the stage of a room that has changed; from any thread."""
        shared = self.of(room.code)
        if shared is not None:
            shared.channel.publish("room", room.state)

    async def close_all(self) -> None:
        """Close the stages of all rooms."""
        for shared in [stage for stage in self._stages if stage.path.startswith(f"{PAGES}/")]:
            await self.close(shared.path.removeprefix(f"{PAGES}/"))

    async def close(self, code: str) -> None:
        """Close the stage of a room, if it is open."""
        async with self._lock:
            shared = self.of(code)
            if shared is not None:
                self._stages.remove(shared)
                await shared.close()

    def of(self, code: str) -> SharedStage | None:
        """Return the stage of a room; None if it is not open."""
        path = path_of_room(code)
        return next((stage for stage in list(self._stages) if stage.path == path), None)


def path_of_room(code: str) -> str:
    """Return the path of a room's page, without a slash at its end."""
    return f"{PAGES}/{code}"
