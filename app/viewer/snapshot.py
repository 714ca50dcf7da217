"""The newest message per thing: what a late joiner needs, and what a laggard has missed.

viser's own replay walks every message id ever issued, which after a day of racing stalls everyone
for seconds. What makes a message redundant is viser's own rule, read from its message classes: a
scene node or a GUI element is created, updated and removed, each newer word replacing an older one.
"""

import itertools
from collections.abc import Iterable
from typing import Any, NamedTuple

from viser import _messages

from app.viewer import wire

UNWANTED = frozenset(
    {
        # Runs as a script in every browser; nothing we draw needs it.
        "RunJavascriptMessage",
        # Ask the browser for an answer, which the hub would not pass on.
        "GetRenderRequestMessage",
        "LocalStorageGetItemRequestMessage",
    }
)
"""Types that are kept from every browser."""

_REPLAY_DONE = "ReplayDoneMessage"


class _Lifecycle(NamedTuple):
    entity: str | None
    phase: str | None
    id_field: str | None


_Entity = tuple[str, str, str]
_Key = tuple[str, ...]


class _Kept(NamedTuple):
    message: wire.Message
    buffers: list[memoryview]
    version: int


_LIFECYCLES = {
    cls.__name__: _Lifecycle(cls.entity_type, cls.lifecycle_phase, cls.entity_id_field)
    for cls in _messages.Message.get_subclasses()
}
_NONE = _Lifecycle(None, None, None)


class Snapshot:
    """All that is to be seen now, and since when each thing is as it is.

    One serves every viewer, so one who lags costs nothing until it can take what it has missed.
    """

    def __init__(self) -> None:
        self.version = 0
        """How many frames were taken in."""
        self.timestamp_s = 0.0
        """When viser sent the newest of them, by its clock."""
        self.complete = False
        """Whether viser has said that it has now told all there was, which its client waits for."""
        # Each is ordered by version.
        self._kept: dict[_Key, _Kept] = {}
        self._removed: dict[_Entity, _Kept] = {}
        self._keys_of: dict[_Entity, set[_Key]] = {}

    def apply(self, frame: wire.Frame) -> None:
        """Take in what a newer frame says."""
        self.version += 1
        self.timestamp_s = frame.timestamp_s
        for message in frame.messages:
            if message["type"] == _REPLAY_DONE:
                self.complete = True
            else:
                self._apply(message, frame.buffers)

    def pack(self, since: int | None = None, more: Iterable[wire.Message] = ()) -> wire.Frame:
        """One frame that brings a viewer up to date.

        Args:
            since: The version that the viewer has; None for one who has nothing yet.
            more: Messages without arrays for the end of the frame.
        """
        if since is None:
            missed = list(self._kept.values())
        else:
            # Removals first: a thing that was made after its namesake was removed comes later.
            missed = [*_newer(self._removed, since), *_newer(self._kept, since)]
        buffers: list[memoryview] = []
        messages = [wire.rewire(kept.message, kept.buffers, buffers) for kept in missed]
        if since is None and self.complete:
            messages.append({"type": _REPLAY_DONE})
        return wire.pack([*messages, *more], buffers, self.timestamp_s)

    @property
    def removals(self) -> int:
        """How many things are remembered only because they are gone."""
        return len(self._removed)

    def forget_removals(self, until: int) -> None:
        """Forget what was gone at that version, once no viewer is older than that."""
        self._removed = {
            entity: kept for entity, kept in self._removed.items() if kept.version > until
        }

    def _apply(self, message: wire.Message, buffers: tuple[memoryview, ...]) -> None:
        lifecycle = _LIFECYCLES.get(message["type"], _NONE)
        entity = _entity(message, lifecycle)
        if entity is not None and lifecycle.phase in ("create", "remove"):
            for key in self._keys_of.pop(entity, ()):
                del self._kept[key]
        own: list[memoryview] = []
        kept = _Kept(wire.rewire(message, buffers, own), own, self.version)
        # To the end, because what is said later may rest on what was said before.
        if entity is not None and lifecycle.phase == "remove":
            self._removed.pop(entity, None)
            self._removed[entity] = kept
            return
        key = _key(message, lifecycle, entity)
        self._kept.pop(key, None)
        self._kept[key] = kept
        if entity is not None:
            self._keys_of.setdefault(entity, set()).add(key)


def _newer(kept: dict[Any, _Kept], since: int) -> list[_Kept]:
    newest_first = reversed(kept.values())
    return list(itertools.takewhile(lambda one: one.version > since, newest_first))[::-1]


def _entity(message: wire.Message, lifecycle: _Lifecycle) -> _Entity | None:
    owner = message.get("owner", "")
    if lifecycle.entity is not None and lifecycle.id_field is not None:
        return (lifecycle.entity, message[lifecycle.id_field], owner)
    if "name" in message:
        # What says something of a scene node beside its life, such as how it can be clicked.
        return ("scene", message["name"], owner)
    return None


def _key(message: wire.Message, lifecycle: _Lifecycle, entity: _Entity | None) -> _Key:
    about = entity or (message["type"], str(message.get("uuid", "")), "")
    if lifecycle.phase == "create":
        return (*about, lifecycle.phase)
    if lifecycle.phase == "update_dict":
        return (*about, message["type"], *sorted(message["updates"]))
    return (*about, message["type"], str(message.get("bone_index", "")))
