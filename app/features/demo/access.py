"""Access of visitors of a demo: which routes and runs a visitor may use.

A visitor is a spectator of a server that is a demo, known by a cookie from the first start on. A
visitor starts trainings and races, and stops, renames and deletes their own; else a visitor does
what spectators do.
"""

from collections.abc import Iterator, Mapping
from typing import Any
from urllib.parse import parse_qsl

from starlette.types import ASGIApp, Scope

from app.api.cookies import SessionCookie, cookie_rules
from app.api.policy import OWN_RUNS, START, Access
from app.api.problems import problem
from app.api.stage_paths import stage_of
from app.features.demo.visitors import Visitors
from app.settings import Settings

VISITOR_NAME = "hexapods_visitor"
"""Beginning of the names of visitors' cookies."""
_ALLOWED = "Visitors of this demo start trainings and races, and stop, rename and delete their own"
_NEEDS_OPERATOR = f"{_ALLOWED}; this needs the operator."
_OF_OTHERS = f"{_ALLOWED}; this run is none of yours. It can be run again, as your own."


class Visitor:
    """The identity of a visitor, also of one who has not started anything yet.

    Attributes:
        cookie: with the visitor's key, empty before the first start.
        page_role: of the visitor's pages; that of a spectator on the stage of others.
    """

    def __init__(self, cookie: SessionCookie, visitors: Visitors, *, is_at_home: bool) -> None:
        """Create the identity of one request.

        Args:
            cookie: see the class.
            visitors: of the server.
            is_at_home: whether the request is about the server's own stage.
        """
        self.cookie, self._visitors, self._is_at_home = cookie, visitors, is_at_home
        self.page_role = "visitor" if is_at_home else "spectator"

    def allowance_key(self, scope: Scope) -> None:
        """Return None: visitors count by their addresses."""

    def refusal(self, scope: Scope, access: Access, as_spectator: ASGIApp | None) -> ASGIApp | None:
        """Return the refusal of a request; None if spectators may send it, or this visitor may."""
        if as_spectator is None:
            return None
        if access is START and self._is_at_home:
            return None
        if access is not OWN_RUNS or not self._is_at_home:
            return problem(403, _NEEDS_OPERATOR)
        run_id = scope["path_params"].get("run_id")
        ids = list(_ids_in_query(scope)) if run_id is None else [run_id]
        if ids and all(self._visitors.owns(self.cookie.value, run_id) for run_id in ids):
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
        cookie = SessionCookie(scope, cookie_rules(scope, self._settings), "", VISITOR_NAME)
        # Another stage, such as that of a class, is no place of visitors.
        return Visitor(cookie, self._visitors, is_at_home=not stage_of(scope).path)

    def requirements(self, access: Access) -> list[dict[str, list[str]]]:
        """Return that a visitor's cookie does; to start something, none is needed: it sets one."""
        if access is START:
            return [{"visitor": []}, {}]
        return [{"visitor": []}] if access is OWN_RUNS else []


def _ids_in_query(scope: Scope) -> Iterator[str]:
    for name, value in parse_qsl(scope["query_string"].decode("latin-1"), keep_blank_values=True):
        if name == "id":
            yield value
