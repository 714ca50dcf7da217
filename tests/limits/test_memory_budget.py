"""Memory budget: the limit for all clients and the share of one."""

from app.limits.memory_budget import MemoryBudget


def test_bytes_are_limited_per_client_and_in_total() -> None:
    budget = MemoryBudget(limit=100, share=60)

    assert budget.reserve("a", 40) is None
    assert budget.reserve("a", 30) == "share"
    assert budget.reserve("a", 20) is None
    assert budget.reserve("b", 50) == "all"
    assert budget.reserve("b", 40) is None
    budget.release("a", 60)
    assert budget.reserve("b", 50) == "share"
    assert budget.reserve("c", 60) is None
    assert budget.held == 100


def test_request_above_the_limit_is_granted_if_it_is_alone() -> None:
    budget = MemoryBudget(limit=100, share=60)

    assert budget.reserve("a", 500) is None
    assert budget.reserve("b", 1) == "all"
    budget.release("a", 500)
    assert budget.held == 0
    assert budget.reserve("b", 1) is None
