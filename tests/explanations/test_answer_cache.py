"""Answers are kept for the pages that ask for the same, within a limit."""

import json

import pytest

from app.explanations import answer_cache
from app.explanations.answer_cache import AnswerCache


def test_an_answer_is_that_of_its_source() -> None:
    cache, log = AnswerCache(), object()
    encoded = cache.put(("a", 1), log, {"value": 0.1, "symbol": "γ"})

    assert json.loads(encoded) == {"value": 0.1, "symbol": "γ"}
    assert cache.get(("a", 1), log) is encoded
    assert cache.get(("a", 1), object()) is None
    assert cache.get(("a", 2), log) is None


def test_the_oldest_answers_are_dropped(monkeypatch: pytest.MonkeyPatch) -> None:
    cache, log = AnswerCache(), object()
    monkeypatch.setattr(answer_cache, "MAX_BYTES", 3 * len(cache.put("x", log, {"n": 0})))
    for number in (1, 2):
        cache.put(number, log, {"n": number})
    cache.get("x", log)
    cache.put(2, log, {"n": 5})
    cache.put(3, log, {"n": 3})

    assert [cache.get(key, log) is not None for key in ("x", 1, 2, 3)] == [True, False, True, True]
