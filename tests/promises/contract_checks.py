"""A check of schemathesis's that is our own; `SCHEMATHESIS_HOOKS` names this module."""

from typing import Any

import schemathesis

CHECK = "refused_for_its_meaning_only"


@schemathesis.check
def refused_for_its_meaning_only(context: Any, response: Any, case: Any) -> None:
    """What the schema allows may be refused for what it means, never for a single field's shape.

    No schema can say whether a leg reaches its cells, or which runs there are. The server names
    fields in `errors` where a value by itself is wrong, and then the schema must say so as well.
    """
    del context
    is_valid = case.meta is not None and case.meta.generation.mode.is_positive
    if is_valid and response.status_code == 422:
        problem = response.json()
        assert "errors" not in problem, f"the schema allows this: {problem['detail']}"
