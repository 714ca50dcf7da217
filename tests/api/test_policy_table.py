"""Each operation is refused, counted and bounded as the committed table says, for each role."""

import json
from typing import Any

import pytest

from tests.features.needing import needs

if needs("classroom", "demo", "tournaments", "what_if").args[0]:
    pytest.skip("the table has operations of all features", allow_module_level=True)

from tests.api.policy_table import TABLE, recorded


def outcomes(table: dict[str, Any]) -> dict[tuple[str, str], str]:
    """Return the outcome, with its sentence, by operation and case."""
    by_case: dict[tuple[str, str], str] = {}
    for operation, of_operation in table["operations"].items():
        for outcome, group in of_operation.items():
            kind, _, number = outcome.removesuffix("]").partition(" [")
            said = table["sentences"][int(number)] if number else ""
            for line in table["groups"][group]:
                server, _, roles = line.partition(": ")
                for role in roles.split(" | "):
                    by_case[operation, f"{server}: {role}"] = f"{kind} {said}".strip()
    return by_case


def test_the_guards_decide_as_the_table_says() -> None:
    """`python -m tests.api.policy_table` writes it anew, if a difference is meant.

    Routes that were added since are not in it: `test_security` holds their policies.
    """
    was, now = outcomes(json.loads(TABLE.read_text("utf-8"))), outcomes(recorded())
    differences = [
        f"{operation}, {case}: was {was.get((operation, case))}, is {now.get((operation, case))}"
        for operation, case in sorted(was)
        if was.get((operation, case)) != now.get((operation, case))
    ]
    assert not differences, "\n".join([f"{len(differences)} differences", *differences[:40]])
    assert len({operation for operation, _ in was}) > 140
    assert len(was) > 5800
