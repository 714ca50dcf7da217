"""Compacted state of the scene: the newest message per key, for late joiners and slow viewers.

viser's own replay iterates over all message ids ever issued, which after a day of racing blocks all
viewers for seconds. Which messages are redundant follows viser's own rule, read from its message
classes: a scene node or GUI element is created, updated and removed, and a newer message replaces
an older one with the same key. Removals are kept as tombstones until all viewers have seen them.
"""

import itertools
from collections.abc import Iterable
from typing import Any, NamedTuple

from viser import _messages

from app.viewer import wire

BLOCKED_TYPES = frozenset(
    {
        # Runs as a script in every browser; nothing we draw needs it.
        "RunJavascriptMessage",
        # Request a reply from the browser, which the hub would not relay.
        "GetRenderRequestMessage",
        "LocalStorageGetItemRequestMessage",
    }
)
"""Message types that are not relayed to browsers."""

_REPLAY_DONE = "ReplayDoneMessage"


class _Lifecycle(NamedTuple):
    entity: str | None
    phase: str | None
    id_field: str | None


_Entity = tuple[str, str, str]
_Key = tuple[str, ...]


class _StoredMessage(NamedTuple):
    message: wire.Message
    buffers: list[memoryview]
    version: int


_LIFECYCLES = {
    cls.__name__: _Lifecycle(cls.entity_type, cls.lifecycle_phase, cls.entity_id_field)
    for cls in _messages.Message.get_subclasses()
}
_NO_LIFECYCLE = _Lifecycle(None, None, None)


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
        self._newest: dict[_Key, _StoredMessage] = {}
        self._tombstones: dict[_Entity, _StoredMessage] = {}
        self._keys_of: dict[_Entity, set[_Key]] = {}

    def apply(self, frame: wire.Frame) -> None:
        """Apply the messages of a newer frame."""
        self.version += 1
        self.timestamp_s = frame.timestamp_s
        for message in frame.messages:
            if message["type"] == _REPLAY_DONE:
                self.complete = True
            else:
                self._apply(message, frame.buffers)

    def pack(self, since: int | None = None, extra: Iterable[wire.Message] = ()) -> wire.Frame:
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
            wire.remap_buffers(stored.message, stored.buffers, buffers) for stored in missed
        ]
        if since is None and self.complete:
            messages.append({"type": _REPLAY_DONE})
        return wire.pack([*messages, *extra], buffers, self.timestamp_s)

    @property
    def tombstones(self) -> int:
        """Number of tombstones."""
        return len(self._tombstones)

    def drop_tombstones(self, until: int) -> None:
        """Drop tombstones up to a version, once no viewer has an older one."""
        self._tombstones = {
            entity: stored for entity, stored in self._tombstones.items() if stored.version > until
        }

    def _apply(self, message: wire.Message, buffers: tuple[memoryview, ...]) -> None:
        lifecycle = _LIFECYCLES.get(message["type"], _NO_LIFECYCLE)
        entity = _entity(message, lifecycle)
        if entity is not None and lifecycle.phase in ("create", "remove"):
            for key in self._keys_of.pop(entity, ()):
                del self._newest[key]
        own_buffers: list[memoryview] = []
        stored = _StoredMessage(
            wire.remap_buffers(message, buffers, own_buffers), own_buffers, self.version
        )
        # Moved to the end, because later messages may depend on earlier ones.
        if entity is not None and lifecycle.phase == "remove":
            self._tombstones.pop(entity, None)
            self._tombstones[entity] = stored
            return
        key = _key(message, lifecycle, entity)
        self._newest.pop(key, None)
        self._newest[key] = stored
        if entity is not None:
            self._keys_of.setdefault(entity, set()).add(key)


def _newer_than(stored: dict[Any, _StoredMessage], since: int) -> list[_StoredMessage]:
    newest_first = reversed(stored.values())
    return list(itertools.takewhile(lambda message: message.version > since, newest_first))[::-1]


def _entity(message: wire.Message, lifecycle: _Lifecycle) -> _Entity | None:
    owner = message.get("owner", "")
    if lifecycle.entity is not None and lifecycle.id_field is not None:
        return (lifecycle.entity, message[lifecycle.id_field], owner)
    if "name" in message:
        # A message on a scene node outside its lifecycle, such as whether it can be clicked.
        return ("scene", message["name"], owner)
    return None


def _key(message: wire.Message, lifecycle: _Lifecycle, entity: _Entity | None) -> _Key:
    subject = entity or (message["type"], str(message.get("uuid", "")), "")
    if lifecycle.phase == "create":
        return (*subject, lifecycle.phase)
    if lifecycle.phase == "update_dict":
        return (*subject, message["type"], *sorted(message["updates"]))
    return (*subject, message["type"], str(message.get("bone_index", "")))
