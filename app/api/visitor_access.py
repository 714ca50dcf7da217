"""What a visitor of a demo may do: the one place where that is decided.

A visitor is a spectator of a server that is a demo, known by a cookie from the first start on. A
visitor starts trainings and races, and stops, renames and deletes their own; else a visitor does
what spectators do.
"""

from collections.abc import Iterator, Mapping
from typing import Any
from urllib.parse import parse_qsl

from starlette.types import ASGIApp, Scope

from app.api.cookies import VISITOR_NAME, SessionCookie, is_secure
from app.api.identity import Identity
from app.api.policy import OWN_RUNS, START, Access
from app.api.problems import problem
from app.api.stage_paths import stage_of
from app.demo.visitors import Visitors
from app.settings import Settings

_ALLOWED = "Visitors of this demo start trainings and races, and stop, rename and delete their own"
_NEEDS_OPERATOR = f"{_ALLOWED}; this needs the operator."
_OF_OTHERS = f"{_ALLOWED}; this run is none of yours. It can be run again, as your own."


class Visitor:
    """The identity of a visitor, also of one who has not started anything yet.

    Attributes:
        limited_as: None: visitors count by their addresses.
    """

    limited_as: str | None = None

    def __init__(self, key: str, visitors: Visitors) -> None:
        """Create the identity of one request, by the key of the visitor's cookie; "" without it."""
        self._key, self._visitors = key, visitors

    def refusal(self, scope: Scope, access: Access, as_spectator: ASGIApp | None) -> ASGIApp | None:
        """Return the refusal of a request; None if spectators may send it, or this visitor may."""
        if as_spectator is None:
            return None
        # The stage of a room is no place of visitors.
        is_at_home = not stage_of(scope).path
        if access is START and is_at_home:
            return None
        if access is not OWN_RUNS or not is_at_home:
            return problem(403, _NEEDS_OPERATOR)
        run_id = scope["path_params"].get("run_id")
        ids = list(_ids_in_query(scope)) if run_id is None else [run_id]
        if ids and all(self._visitors.owns(self._key, one) for one in ids):
            return None
        return problem(403, _OF_OTHERS)


class VisitorAccess:
    """Knows visitors: every spectator of a demo is one.

    Attributes:
        scheme: of a visitor's cookie.
    """

    def __init__(self, visitors: Visitors, settings: Settings) -> None:
        """Decide about these visitors."""
        self._visitors, self._settings = visitors, settings
        self.scheme: tuple[str, Mapping[str, Any]] = (
            "visitor",
            {
                "type": "apiKey",
                "in": "cookie",
                "name": f"{VISITOR_NAME}_{settings.port}",
                "description": "set by the first start of a visitor; it opens their own runs to "
                "them",
            },
        )

    def identify(self, scope: Scope) -> Visitor | None:
        """Return the visitor; None where nobody needs a token, as all are operators there."""
        if not stage_of(scope).roles.needs_token:
            return None
        secure = is_secure(scope, self._settings)
        cookie = SessionCookie(scope, secure, "", VISITOR_NAME)
        scope["state"]["visitor"] = cookie
        return Visitor(cookie.value, self._visitors)

    def why_hidden(self, run_id: str, identity: Identity | None) -> None:
        """Hide nothing: all see what visitors run."""
        del run_id, identity

    def requirements(self, access: Access) -> list[dict[str, list[str]]]:
        """Return that a visitor's cookie does; to start something, none is needed: it sets one."""
        if access is START:
            return [{"visitor": []}, {}]
        return [{"visitor": []}] if access is OWN_RUNS else []


def _ids_in_query(scope: Scope) -> Iterator[str]:
    for name, value in parse_qsl(scope["query_string"].decode("latin-1"), keep_blank_values=True):
        if name == "id":
            yield value
