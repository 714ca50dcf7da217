"""Strict JSON encoding: NaN and infinities, which JSON lacks, are sent as null."""

import json
import logging
import math
from typing import Any

_logger = logging.getLogger(__name__)


def json_text(data: Any) -> str:
    """Encode plain types as JSON, with null in place of NaN and infinities."""
    try:
        return json.dumps(data, allow_nan=False)
    except ValueError:
        _logger.warning("NaN or infinity is sent as null")
        return json.dumps(finite(data), allow_nan=False)


def read_json(text: object) -> Any:
    """Parse the JSON text of a column; return None if it is not valid JSON."""
    try:
        return json.loads(str(text))
    except (ValueError, RecursionError):
        return None


def finite(data: Any) -> Any:
    """Return a copy of plain types with None in place of each NaN or infinity."""
    if isinstance(data, float) and not math.isfinite(data):
        return None
    if isinstance(data, dict):
        return {name: finite(value) for name, value in data.items()}
    if isinstance(data, list | tuple):
        return [finite(value) for value in data]
    return data


def is_finite(data: Any) -> bool:
    """Whether plain types contain no NaN and no infinity."""
    if isinstance(data, float):
        return math.isfinite(data)
    if isinstance(data, dict):
        return all(is_finite(value) for value in data.values())
    return not isinstance(data, list | tuple) or all(is_finite(value) for value in data)
