"""The newest message per thing: what a late joiner needs, and what a laggard's backlog shrinks to.

viser's own replay walks every message id ever issued, which after a day of racing stalls everyone
for seconds. What makes a message redundant is viser's own rule, read from its message classes: a
scene node or a GUI element is created, updated and removed, each newer word replacing an older one.
"""

from typing import NamedTuple

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


class _Kept(NamedTuple):
    message: wire.Message
    buffers: list[memoryview]


_Entity = tuple[str, str, str]
_Key = tuple[str, ...]

_LIFECYCLES = {
    cls.__name__: _Lifecycle(cls.entity_type, cls.lifecycle_phase, cls.entity_id_field)
    for cls in _messages.Message.get_subclasses()
}
_NONE = _Lifecycle(None, None, None)


class Snapshot:
    """Folds frames into the one frame that says the same, and no more."""

    def __init__(self, *, keep_removals: bool = False) -> None:
        """Start empty.

        Args:
            keep_removals: For someone who has seen what came before, and must be told what is gone.
        """
        self._keep_removals = keep_removals
        self._kept: dict[_Key, _Kept] = {}
        self._keys_of: dict[_Entity, set[_Key]] = {}
        self._timestamp_s = 0.0
        self.complete = False
        """Whether viser has said that it has now told all there was, which its client waits for."""

    def apply(self, frame: wire.Frame) -> None:
        """Take in what a newer frame says."""
        self._timestamp_s = frame.timestamp_s
        for message in frame.messages:
            if message["type"] == _REPLAY_DONE:
                self.complete = True
            else:
                self._apply(message, frame.buffers)

    def pack(self) -> wire.Frame:
        """The one frame."""
        buffers: list[memoryview] = []
        messages = [
            wire.rewire(kept.message, kept.buffers, buffers) for kept in self._kept.values()
        ]
        if self.complete:
            messages.append({"type": _REPLAY_DONE})
        return wire.pack(messages, buffers, self._timestamp_s)

    def _apply(self, message: wire.Message, buffers: tuple[memoryview, ...]) -> None:
        lifecycle = _LIFECYCLES.get(message["type"], _NONE)
        entity = _entity(message, lifecycle)
        if entity is not None and lifecycle.phase in ("create", "remove"):
            self._forget(entity)
        if lifecycle.phase == "remove" and not self._keep_removals:
            return
        own: list[memoryview] = []
        kept = _Kept(wire.rewire(message, buffers, own), own)
        key = _key(message, lifecycle, entity)
        # To the end, because what is said later may rest on what was said before.
        self._kept.pop(key, None)
        self._kept[key] = kept
        if entity is not None:
            self._keys_of.setdefault(entity, set()).add(key)

    def _forget(self, entity: _Entity) -> None:
        # But its removal: who has seen an older thing of that name must drop that one's pose too.
        removal = (*entity, "remove")
        keys = self._keys_of.pop(entity, set())
        for key in keys - {removal}:
            del self._kept[key]
        if removal in keys:
            self._keys_of[entity] = {removal}


class Backlog:
    """Frames that wait for one viewer: in order while they are few, else folded into one.

    It is never larger than the scene, however long the viewer does not read.
    """

    LIMIT = 4

    def __init__(self) -> None:
        self._frames: list[wire.Frame] = []
        self._folded: Snapshot | None = None
        self.merged = 0
        """How many frames were folded, in all."""

    def push(self, frame: wire.Frame) -> None:
        """Let a frame wait."""
        if self._folded is None and len(self._frames) < self.LIMIT:
            self._frames.append(frame)
            return
        if self._folded is None:
            self._folded = Snapshot(keep_removals=True)
            for waiting in self._frames:
                self._folded.apply(waiting)
            self.merged += len(self._frames)
            self._frames.clear()
        self._folded.apply(frame)
        self.merged += 1

    def take(self) -> list[wire.Frame]:
        """All that waits, in order; none of it waits any more."""
        frames = self._frames if self._folded is None else [self._folded.pack()]
        self._frames, self._folded = [], None
        return frames


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
    if lifecycle.phase in ("create", "remove"):
        return (*about, lifecycle.phase)
    if lifecycle.phase == "update_dict":
        return (*about, message["type"], *sorted(message["updates"]))
    return (*about, message["type"], str(message.get("bone_index", "")))
