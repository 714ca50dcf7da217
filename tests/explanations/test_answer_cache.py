"""Answers are kept for the pages that ask for the same, within a limit."""

import json

import pytest

from app.explanations import answer_cache
from app.explanations.answer_cache import AnswerCache


def test_answers_are_kept_by_what_they_depend_on() -> None:
    cache = AnswerCache()
    encoded = cache.put(("a", 1), {"value": 0.1, "symbol": "γ"})

    assert json.loads(encoded) == {"value": 0.1, "symbol": "γ"}
    assert cache.get(("a", 1)) is encoded
    assert cache.get(("a", 2)) is None


def test_the_oldest_answers_are_dropped(monkeypatch: pytest.MonkeyPatch) -> None:
    cache = AnswerCache()
    monkeypatch.setattr(answer_cache, "MAX_BYTES", 3 * len(cache.put("x", {"n": 0})))
    for number in (1, 2):
        cache.put(number, {"n": number})
    cache.get("x")
    cache.put(2, {"n": 5})
    cache.put(3, {"n": 3})

    assert [cache.get(key) is not None for key in ("x", 1, 2, 3)] == [True, False, True, True]
