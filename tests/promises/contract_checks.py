"""A custom check and filter for schemathesis, which loads this module by `SCHEMATHESIS_HOOKS`."""

from collections import Counter
from typing import Any

import schemathesis

from tests.promises.length import at_length

CHECK = "refused_for_its_meaning_only"


@schemathesis.check
def refused_for_its_meaning_only(context: Any, response: Any, case: Any) -> None:
    """Check that valid data is refused only for its meaning, never for a single field's value.

    No schema can express whether a leg reaches its cells, or which runs exist. The server lists
    fields in `errors` where a value by itself is invalid, and then the schema must exclude it too.
    """
    del context
    is_valid = case.meta is not None and case.meta.generation.mode.is_positive
    if is_valid and response.status_code == 422:
        problem = response.json()
        assert "errors" not in problem, f"the schema allows this: {problem['detail']}"


SOME = at_length(3, 1)
_seen: Counter[tuple[str, str | None, str | None]] = Counter()
"""Number of systematic cases by operation, parameter and what they are about."""


@schemathesis.hook
def filter_case(context: Any, case: Any) -> bool:
    """Keep the first of the systematic cases about the same, and in the gate every third further.

    Such as the wrong types of a field, or its names; which of them is another for each field.
    """
    del context
    if case.meta is None or case.meta.phase.name.value != "coverage":
        return True
    data = case.meta.phase.data
    about = (case.operation.label, data.parameter, data.description)
    number, _seen[about] = _seen[about], _seen[about] + 1
    return number == 0 or (number + len(_seen)) % SOME == 0
