"""A custom check for schemathesis, which loads this module by `SCHEMATHESIS_HOOKS`."""

from typing import Any

import schemathesis

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
