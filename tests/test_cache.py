"""The cache of encoded answers: by what they depend on, within a limit, computed once."""

from concurrent.futures import ThreadPoolExecutor

from app.cache import BytesCache


def test_the_least_recently_used_values_are_dropped() -> None:
    cache = BytesCache(max_bytes=9)
    for key in (("a", 1), ("a", 2), ("a", 3)):
        cache.put(key, b"abc")
    cache.get(("a", 1))
    cache.put(("a", 3), b"xyz")
    cache.put(("a", 4), b"abc")

    values = [cache.get(("a", number)) for number in (1, 2, 3, 4)]
    assert values == [b"abc", None, b"xyz", b"abc"]


def test_the_newest_value_is_kept_whatever_its_size() -> None:
    cache = BytesCache(max_bytes=9)
    cache.put("a", b"abc")
    cache.put("b", bytes(20))
    assert (cache.get("a"), cache.get("b")) == (None, bytes(20))
    cache.put("c", b"abc")
    assert (cache.get("b"), cache.get("c")) == (None, b"abc")


def test_a_value_is_computed_once_however_many_request_it() -> None:
    cache, computed = BytesCache(max_bytes=9), []

    def compute() -> bytes:
        computed.append(1)
        return b"abc"

    with ThreadPoolExecutor(8) as pool:
        values = list(pool.map(lambda _: cache.computed("key", compute), range(50)))
    assert values == [b"abc"] * 50
    assert len(computed) == 1
    assert cache.computed("other", lambda: b"xyz") == b"xyz"
