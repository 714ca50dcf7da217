"""What a visitor of a demo may do: the one place where that is decided.

A visitor is a spectator of a server that is a demo, known by a cookie from the first start on. A
visitor starts trainings and races, and stops, renames and deletes their own; else a visitor does
what spectators do. `TokenGuard` asks here after the rules of rooms and of spectators.
"""

import re
from collections.abc import Iterator, Mapping
from urllib.parse import parse_qsl

from starlette.types import ASGIApp, Scope

from app.api.cookies import VISITOR_NAME, SessionCookie
from app.api.problems import problem
from app.api.stage_paths import path_of
from app.demo.visitors import Visitors

STARTS = frozenset(
    {
        ("post", "/api/v1/trainings"),
        ("post", "/api/v1/races"),
        ("post", "/api/v1/runs/{run_id}/again"),
    }
)
"""Operations of every visitor, within the allowance."""
OF_OWN_RUNS = frozenset(
    {
        ("post", "/api/v1/trainings/{run_id}/stop"),
        ("post", "/api/v1/races/{run_id}/stop"),
        ("patch", "/api/v1/runs/{run_id}"),
        ("delete", "/api/v1/trainings/{run_id}"),
        ("delete", "/api/v1/races/{run_id}"),
        ("delete", "/api/v1/runs"),
    }
)
"""Operations of who has started the run; of several runs, of who has started all."""
_RUN = r"(?P<run>[^/]+)"
_ALLOWED = "Visitors of this demo start trainings and races, and stop, rename and delete their own"
_NEEDS_OPERATOR = f"{_ALLOWED}; this needs the operator."
_OF_OTHERS = f"{_ALLOWED}; this run is none of yours. It can be run again, as your own."


class VisitorAccess:
    """Decides what a visitor may do. Thread-safe."""

    def __init__(self, visitors: Visitors) -> None:
        """Decide about these visitors."""
        self._visitors = visitors

    def refuse(self, scope: Scope, key: str) -> ASGIApp | None:
        """Return the refusal of a request that no spectator may send; None if a visitor may.

        Args:
            scope: of the request, or of a websocket.
            key: of the visitor's cookie; "" without one.
        """
        # The stage of a room is no place of visitors.
        is_elsewhere = scope["type"] != "http" or bool(scope["root_path"])
        if not is_elsewhere and _found(STARTS, scope) is not None:
            return None
        found = None if is_elsewhere else _found(OF_OWN_RUNS, scope)
        if found is None:
            return problem(403, _NEEDS_OPERATOR)
        ids = [found["run"]] if "run" in found else list(_ids_in_query(scope))
        if ids and all(self._visitors.owns(key, one) for one in ids):
            return None
        return problem(403, _OF_OTHERS)


def visitor_cookie(scope: Scope, *, is_secure: bool) -> SessionCookie:
    """Return the cookie of a visitor."""
    return SessionCookie(scope, is_secure, "", VISITOR_NAME)


def _found(operations: frozenset[tuple[str, str]], scope: Scope) -> Mapping[str, str] | None:
    """Return the parameters of the operation that a request is; None if it is none of these."""
    for method, template in operations:
        path = re.fullmatch(template.replace("{run_id}", _RUN), path_of(scope))
        if path is not None and scope["method"].lower() == method:
            return path.groupdict()
    return None


def _ids_in_query(scope: Scope) -> Iterator[str]:
    for name, value in parse_qsl(scope["query_string"].decode("latin-1"), keep_blank_values=True):
        if name == "id":
            yield value
