"""Cache of answers: many pages that follow the same stage ask for the same steps."""

import json
import threading
from collections import OrderedDict
from collections.abc import Hashable
from typing import Any

MAX_BYTES = 16_000_000


class AnswerCache:
    """Answers as JSON, by what was asked; the oldest are dropped. Thread-safe.

    An answer is that of one source, such as the log of a training, and is no answer where the
    source is another one.
    """

    def __init__(self) -> None:
        self._answers: OrderedDict[Hashable, tuple[object, bytes]] = OrderedDict()
        self._size, self._lock = 0, threading.Lock()

    def get(self, key: Hashable, source: object) -> bytes | None:
        """Return an answer; None if it is not known."""
        with self._lock:
            known_source, answer = self._answers.get(key, (None, b""))
            if known_source is not source:
                return None
            self._answers.move_to_end(key)
            return answer

    def put(self, key: Hashable, source: object, answer: dict[str, Any]) -> bytes:
        """Keep an answer, and return it as JSON."""
        encoded = json.dumps(answer, ensure_ascii=False, allow_nan=False).encode()
        with self._lock:
            _, former = self._answers.pop(key, (None, b""))
            self._answers[key] = source, encoded
            self._size += len(encoded) - len(former)
            while self._size > MAX_BYTES:
                _, (_, dropped) = self._answers.popitem(last=False)
                self._size -= len(dropped)
        return encoded
