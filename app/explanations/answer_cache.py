"""Cache of answers: many pages that follow the same stage ask for the same steps."""

import json
import threading
from collections import OrderedDict
from collections.abc import Hashable
from typing import Any

MAX_BYTES = 16_000_000


class AnswerCache:
    """Answers as JSON, by all that they depend on; the oldest are dropped. Thread-safe."""

    def __init__(self) -> None:
        self._answers: OrderedDict[Hashable, bytes] = OrderedDict()
        self._size, self._lock = 0, threading.Lock()

    def get(self, key: Hashable) -> bytes | None:
        """Return an answer; None if it is not known."""
        with self._lock:
            if key in self._answers:
                self._answers.move_to_end(key)
            return self._answers.get(key)

    def put(self, key: Hashable, answer: dict[str, Any]) -> bytes:
        """Keep an answer, and return it as JSON."""
        encoded = json.dumps(answer, ensure_ascii=False, allow_nan=False).encode()
        with self._lock:
            self._size += len(encoded) - len(self._answers.pop(key, b""))
            self._answers[key] = encoded
            while self._size > MAX_BYTES:
                self._size -= len(self._answers.popitem(last=False)[1])
        return encoded
