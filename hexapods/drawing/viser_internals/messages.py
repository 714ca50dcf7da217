"""viser's messages in decoded form: what they do to scene nodes, and the arrays they reference.

A message names an array by its index in a list: `{"__binary_index": 3, "dtype": "<f4"}`.
"""

from collections.abc import Sequence
from typing import Any

from viser import _messages

Message = dict[str, Any]
"""One decoded message; its `type` is the name of viser's class."""

BLOCKED_TYPES = frozenset(
    cls.__name__
    for cls in (
        # Runs as a script in every browser; nothing we draw needs it.
        _messages.RunJavascriptMessage,
        # Request a reply from the browser, which reaches no server.
        _messages.GetRenderRequestMessage,
        _messages.LocalStorageGetItemRequestMessage,
    )
)
"""Message types that are not sent to browsers."""

LIFECYCLES = {
    cls.__name__: (cls.entity_type, cls.lifecycle_phase, cls.entity_id_field)
    for cls in _messages.Message.get_subclasses()
}
"""By message type the kind of its entity (`scene`, `gui`, …), the phase (`create`, `update_dict`,
`update_simple`, `remove`) and the field with the entity's id; None where it has no lifecycle."""

_INDEX_KEY = "__binary_index"


def remap_buffers(value: Any, source: Sequence[memoryview], target: list[memoryview]) -> Any:
    """Copy a message, or a part of one, with its array indices remapped to another list.

    Args:
        value: References arrays in `source` by index; not mutated.
        source: The arrays that it references.
        target: Each referenced array is appended; the copy's index points to it there.
    """
    if isinstance(value, dict):
        if _INDEX_KEY in value:
            target.append(source[value[_INDEX_KEY]])
            return {**value, _INDEX_KEY: len(target) - 1}
        return {key: remap_buffers(item, source, target) for key, item in value.items()}
    if isinstance(value, list):
        return [remap_buffers(item, source, target) for item in value]
    return value


def array_index(value: dict[str, Any]) -> int:
    """Return the index of the array that a value of a message names."""
    index: int = value[_INDEX_KEY]
    return index
