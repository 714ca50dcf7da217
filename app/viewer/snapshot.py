"""Compacted state of the scene: the newest message per key, for late joiners and slow viewers.

viser's own replay iterates over all message ids ever issued, which after a day of racing blocks all
viewers for seconds. Here a newer message replaces an older one with the same key, and the removal
of a scene node or GUI element all that was sent about it. Removals are kept as tombstones until all
viewers have seen them.
"""

import itertools
from collections.abc import Iterable
from typing import Any, NamedTuple

from hexapods.drawing.viser_internals import stream
from hexapods.drawing.viser_internals.stream import REPLAY_DONE, Entity, Key, slot_of


class _StoredMessage(NamedTuple):
    message: stream.Message
    buffers: list[memoryview]
    version: int


class Snapshot:
    """The newest message per key, each with the version (frame number) at which it arrived.

    One instance serves all viewers: a slow viewer needs no buffer of its own, only its version.
    """

    def __init__(self) -> None:
        self.version = 0
        """Number of frames applied."""
        self.timestamp_s = 0.0
        """When viser sent the newest frame, by viser's clock [s]."""
        self.complete = False
        """Whether viser's backlog is complete (`ReplayDoneMessage`), which its client waits for."""
        # Each is ordered by version.
        self._newest: dict[Key, _StoredMessage] = {}
        self._tombstones: dict[Entity, _StoredMessage] = {}
        self._keys_of: dict[Entity, set[Key]] = {}

    def apply(self, frame: stream.Frame) -> None:
        """Apply the messages of a newer frame."""
        self.version += 1
        self.timestamp_s = frame.timestamp_s
        for message in frame.messages:
            if message["type"] == REPLAY_DONE:
                self.complete = True
            else:
                self._apply(message, frame.buffers)

    def pack(self, since: int | None = None, extra: Iterable[stream.Message] = ()) -> stream.Frame:
        """Encode one catch-up frame that brings a viewer up to date.

        Args:
            since: The version that the viewer has; None for a new viewer.
            extra: Messages without arrays to append.
        """
        if since is None:
            missed = list(self._newest.values())
        else:
            # Tombstones first, since a name may have been created again after its removal.
            missed = [*_newer_than(self._tombstones, since), *_newer_than(self._newest, since)]
        buffers: list[memoryview] = []
        messages = [
            stream.remap_buffers(stored.message, stored.buffers, buffers) for stored in missed
        ]
        if since is None and self.complete:
            messages.append({"type": REPLAY_DONE})
        return stream.pack([*messages, *extra], buffers, self.timestamp_s)

    @property
    def tombstones(self) -> int:
        """Number of tombstones."""
        return len(self._tombstones)

    def drop_tombstones(self, until: int) -> None:
        """Drop tombstones up to a version, once no viewer has an older one."""
        self._tombstones = {
            entity: stored for entity, stored in self._tombstones.items() if stored.version > until
        }

    def _apply(self, message: stream.Message, buffers: tuple[memoryview, ...]) -> None:
        slot = slot_of(message)
        if slot.entity is not None and slot.phase in ("create", "remove"):
            for key in self._keys_of.pop(slot.entity, ()):
                del self._newest[key]
        own_buffers: list[memoryview] = []
        stored = _StoredMessage(
            stream.remap_buffers(message, buffers, own_buffers), own_buffers, self.version
        )
        # Moved to the end, because later messages may depend on earlier ones.
        if slot.entity is not None and slot.phase == "remove":
            self._tombstones.pop(slot.entity, None)
            self._tombstones[slot.entity] = stored
            return
        self._newest.pop(slot.key, None)
        self._newest[slot.key] = stored
        if slot.entity is not None:
            self._keys_of.setdefault(slot.entity, set()).add(slot.key)


def _newer_than(stored: dict[Any, _StoredMessage], since: int) -> list[_StoredMessage]:
    newest_first = reversed(stored.values())
    return list(itertools.takewhile(lambda message: message.version > since, newest_first))[::-1]
