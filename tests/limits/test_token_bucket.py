"""Token bucket: tokens are used up, and are refilled with time."""

from app.limits.token_bucket import MAX_CLIENTS, RateLimiter


def test_tokens_are_used_up_and_refilled_per_caller() -> None:
    clock = [1000.0]
    buckets = RateLimiter(2, 0.5, lambda: clock[0])
    assert [buckets.take("a") for _ in range(3)] == [0, 0, 2]
    assert buckets.take("b") == 0
    clock[0] += 1
    assert buckets.take("a") == 1
    clock[0] += 1
    assert [buckets.take("a"), buckets.take("a")] == [0, 2]
    clock[0] += 1e6
    assert [buckets.take("a") for _ in range(3)] == [0, 0, 2]


def test_a_bucket_may_owe_what_something_cost() -> None:
    clock = [1000.0]
    buckets = RateLimiter(2, 0.5, lambda: clock[0])
    assert buckets.take("a") == 0
    buckets.charge("a", 1)
    assert buckets.debt_s("a") == 0
    buckets.charge("a", 3)
    assert (buckets.debt_s("a"), buckets.take("a"), buckets.debt_s("b")) == (6, 8, 0)
    clock[0] += 6
    assert (buckets.debt_s("a"), buckets.take("a")) == (0, 2)


def test_least_recently_used_buckets_are_dropped() -> None:
    buckets = RateLimiter(1, 1e-9, lambda: 0.0)
    buckets.take("first")
    for number in range(MAX_CLIENTS):
        buckets.take(str(number))
    assert buckets.take("first") == 0
    assert buckets.take(str(MAX_CLIENTS - 1)) > 0
