"""JSON as it is sent to everyone: one number that JSON has not must not break a stream."""

import json
import logging
import math
from typing import Any

_logger = logging.getLogger(__name__)


def json_text(data: Any) -> str:
    """The JSON of plain types; a NaN or an infinity, which JSON has not, becomes null."""
    try:
        return json.dumps(data, allow_nan=False)
    except ValueError:
        _logger.warning("a number that is none is sent as null")
        return json.dumps(finite(data), allow_nan=False)


def finite(data: Any) -> Any:
    """The same with None in place of each number that JSON has not."""
    if isinstance(data, float) and not math.isfinite(data):
        return None
    if isinstance(data, dict):
        return {name: finite(value) for name, value in data.items()}
    if isinstance(data, list | tuple):
        return [finite(value) for value in data]
    return data


def is_finite(data: Any) -> bool:
    """Whether every number in plain types is one that JSON has."""
    if isinstance(data, float):
        return math.isfinite(data)
    if isinstance(data, dict):
        return all(is_finite(value) for value in data.values())
    return not isinstance(data, list | tuple) or all(is_finite(value) for value in data)
