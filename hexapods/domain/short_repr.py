"""Short `repr`s of dataclasses: fields that differ from the defaults, and sizes of long values."""

from collections.abc import Mapping
from dataclasses import MISSING, Field, fields
from typing import Any

import numpy as np

MAX_REPR = 300
"""Most characters of a `repr`."""
_MAX_VALUE = 100


def short_repr(record: Any) -> str:
    """Return the `repr` of a dataclass with its name and the fields that differ from the defaults.

    Arrays and long values are shown by their type and size.
    """
    shown = [field for field in fields(record) if field.repr and _is_shown(record, field)]
    values = ", ".join(f"{field.name}={_short(getattr(record, field.name))}" for field in shown)
    text = f"{type(record).__name__}({values})"
    return text if len(text) <= MAX_REPR else f"{text[: MAX_REPR - 2]}…)"


def _is_shown(record: Any, field: "Field[Any]") -> bool:
    value, default = getattr(record, field.name), field.default
    if field.default_factory is not MISSING:
        default = field.default_factory()
    return field.name == "name" or default is MISSING or bool(value != default)


def _short(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f"<{value.dtype} {value.shape}>"
    if isinstance(value, tuple | list) and len(value) > 2 * _MAX_VALUE:
        return f"<{len(value):,} {type(value[0]).__name__}>"  # without the `repr` of each
    text = repr(value)
    if len(text) <= _MAX_VALUE:
        return text
    if isinstance(value, tuple | list):
        return f"<{len(value):,} {type(value[0]).__name__}>"
    if isinstance(value, Mapping):
        return f"<{len(value):,} entries>"
    return f"{text[: _MAX_VALUE - 1]}…"
