"""Memory budget: the limit for all clients and the share of one."""

from app.limits.memory_budget import MemoryBudget


def test_bytes_are_limited_per_client_and_in_total() -> None:
    budget = MemoryBudget(limit=100, share=60)

    assert budget.take("a", 40) is None
    assert budget.take("a", 30) == "share"
    assert budget.take("a", 20) is None
    assert budget.take("b", 50) == "all"
    assert budget.take("b", 40) is None
    budget.give_back("a", 60)
    assert budget.take("b", 50) == "share"
    assert budget.take("c", 60) is None
    assert budget.held == 100


def test_request_above_the_limit_is_granted_if_it_is_alone() -> None:
    budget = MemoryBudget(limit=100, share=60)

    assert budget.take("a", 500) is None
    assert budget.take("b", 1) == "all"
    budget.give_back("a", 500)
    assert budget.held == 0
    assert budget.take("b", 1) is None
