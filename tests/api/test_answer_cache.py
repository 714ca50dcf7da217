"""The cache of answers that many pages request at once."""

from concurrent.futures import ThreadPoolExecutor

from app.api.answer_cache import MAX_BYTES, AnswerCache


def test_an_answer_is_computed_once_however_many_request_it() -> None:
    cache, computed = AnswerCache(), []

    def compute() -> bytes:
        computed.append(1)
        return b"answer"

    with ThreadPoolExecutor(8) as pool:
        answers = list(pool.map(lambda _: cache.get("key", compute), range(50)))
    assert answers == [b"answer"] * 50
    assert len(computed) == 1
    assert cache.get("other", lambda: b"another") == b"another"


def test_the_oldest_answers_make_room() -> None:
    cache = AnswerCache()
    for key in range(4):
        cache.get(key, lambda: bytes(MAX_BYTES // 3))
    assert cache.get(3, lambda: b"new") != b"new"
    assert cache.get(0, lambda: b"new") == b"new"
    assert len(cache.get("large", lambda: bytes(2 * MAX_BYTES))) == 2 * MAX_BYTES
    assert cache.get("large", lambda: b"new") != b"new"
