"""The policy of a route: who may use it, and what it costs.

The guards and the description of the API read it, and nothing else. It stands where the route is
written, under the decorator that adds it, and a route without one cannot be defined:

    @router.post("/races")
    @policy(access=START, starts=True)
    def start_race(...): ...

A route runs the guards (`guards`) when it was matched and before its body is read. Features define
accesses and kinds of work (`work`) of their own, and identities who may use them (`identity`).
"""

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Any, Literal, TypeVar
from urllib.parse import quote

from fastapi import FastAPI
from fastapi.routing import APIRoute, APIRouter, iter_route_contexts
from starlette.responses import RedirectResponse
from starlette.routing import BaseRoute, Match, Mount, Route
from starlette.types import ASGIApp, Receive, Scope, Send

from app.api.record_response import response_model
from app.api.stage_paths import path_of
from app.api.work import OTHER, Work

READ_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})
_ATTRIBUTE = "policy"
E = TypeVar("E", bound=Callable[..., Any])


@dataclass(frozen=True, kw_only=True)
class Access:
    """Who may use a route. Operators always get to it; what others may, is decided here.

    Attributes:
        name: of this access.
        spectators: whether those may use it of whom nothing else is known: `never`, `always`, or
            `watching`, which is where watching needs no token.
        is_read: whether the route shows something, and neither changes nor computes anything.
        is_for_operators: whether to be an operator is enough; false for what only those can do
            whom a feature knows.
    """

    name: str
    spectators: Literal["always", "watching", "never"] = "never"
    is_read: bool = False
    is_for_operators: bool = True

    def admits_spectators(self, *, is_public: bool) -> bool:
        """Whether spectators may use the route.

        Args:
            is_public: whether watching needs no token.
        """
        return self.spectators == "always" or (self.spectators == "watching" and is_public)


PUBLIC = Access(name="public", spectators="always", is_read=True)
"""Needs no token on any server: the page's files, not the data it shows, and probes."""
WATCH = Access(name="watch", spectators="watching", is_read=True)
"""Shows something of the server to those who may watch."""
WATCH_RUN = Access(name="watch run", spectators="watching", is_read=True)
"""Shows something of the run `run_id` of the path."""
WATCH_STAGE = Access(name="watch stage", spectators="watching", is_read=True)
"""Shows what is on the stage of the path."""
WATCH_REPLAY = Access(name="watch replay", spectators="watching", is_read=True)
"""Shows the picture of the run `run_id` of the path: as `WATCH_RUN`, or as `WATCH_STAGE` while that
run is on the stage of the path, even if it is hidden otherwise."""
ANY_PAGE = Access(name="any page", spectators="watching", is_read=True)
"""Tells what every page needs, whatever it shows."""
QUESTION = Access(name="question", spectators="watching")
"""Computes something and changes nothing, so that those who may watch may ask it."""
OPERATOR = Access(name="operator")
START = Access(name="start")
"""Starts a run: operators, and who a feature lets start some; `TokenGuard` refuses all others."""
OWN_RUNS = Access(name="own runs")
"""Changes the run `run_id` of the path, or all runs `id` of the query: operators, and who owns all
of them."""


@dataclass(frozen=True, kw_only=True)
class RoutePolicy:
    """Attributes of a route that the guards read.

    Attributes:
        access: who may use it.
        work: kind of its work, or a function that tells it by the request's scope.
        starts: whether it counts as a start: of a run, or of something else that costs the server.
        takes_file: whether its body may be as large as a file.
        opens_session: whether `token` in its query opens an operator's session.
        depends_on_state: whether what is asked of the thing that the path names can be refused for
            the state of that thing, such as a recording of a run that waits; not if the thing is
            shown itself.
    """

    access: Access
    work: Work | Callable[[Scope], Work] = OTHER
    starts: bool = False
    takes_file: bool = False
    opens_session: bool = False
    depends_on_state: bool = True


Guards = Callable[[RoutePolicy, ASGIApp, Scope, Receive, Send], Awaitable[None]]
"""Calls an app for a request if all guards let it pass, or refuses it."""


class MissingPolicy(TypeError):
    """A route has no policy."""

    def __init__(self, path: str) -> None:
        super().__init__(
            f"the route {path} has no policy; say who may use it and what it costs by "
            "@policy(access=…) under the decorator that adds it (app/api/policy.py)"
        )


def policy(
    *,
    access: Access,
    work: Work | Callable[[Scope], Work] = OTHER,
    starts: bool = False,
    takes_file: bool = False,
    opens_session: bool = False,
    depends_on_state: bool = True,
) -> Callable[[E], E]:
    """Put a policy on an endpoint; the arguments are those of `Policy`."""
    return with_policy(
        RoutePolicy(
            access=access,
            work=work,
            starts=starts,
            takes_file=takes_file,
            opens_session=opens_session,
            depends_on_state=depends_on_state,
        )
    )


def with_policy(of_route: RoutePolicy) -> Callable[[E], E]:
    """Put a policy that there is on an endpoint."""

    def put(endpoint: E) -> E:
        setattr(endpoint, _ATTRIBUTE, of_route)
        return endpoint

    return put


def _policy_on(endpoint: object, path: str) -> RoutePolicy:
    on_endpoint: RoutePolicy | None = getattr(endpoint, _ATTRIBUTE, None)
    if on_endpoint is None:
        raise MissingPolicy(path)
    return on_endpoint


def policy_without_route(scope: Scope) -> RoutePolicy:
    """Return the policy of a path without a route, and of a method that its route does not have."""
    if scope["method"] in READ_METHODS:
        return RoutePolicy(access=WATCH)
    return RoutePolicy(access=OPERATOR, starts=scope["method"] == "POST")


def policy_of(scope: Scope) -> RoutePolicy:
    """Return the policy of a request; to be called inside the guards."""
    of_route: RoutePolicy = scope["state"]["policy"]
    return of_route


def work_of(scope: Scope) -> Work:
    """Return the kind of work of a request, which is decided once; inside `TokenGuard`."""
    state = scope["state"]
    if "work" not in state:
        work = policy_of(scope).work
        work = work(scope) if callable(work) else work
        is_unlimited = work.operators is None and state["role"] == "operator"
        state["work"] = OTHER if is_unlimited else work
    work_of_request: Work = state["work"]
    return work_of_request


async def _guard(
    of_route: RoutePolicy, app: ASGIApp, scope: Scope, receive: Receive, send: Send
) -> None:
    guards: Guards = scope["app"].state.guards
    await guards(of_route, app, scope, receive, send)


class GuardedRoute(APIRoute):
    """A route of the API, behind the guards.

    Attributes:
        policy: that of its endpoint.
    """

    def __init__(self, path: str, endpoint: Callable[..., Any], **options: Any) -> None:
        """Create a route; its response model is the record that the endpoint returns.

        Raises:
            MissingPolicy: if there is no policy on the endpoint.
        """
        self.policy = _policy_on(endpoint, path)
        if (model := response_model(endpoint)) is not None:
            options["response_model"] = model
        super().__init__(path, endpoint, **options)

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request that matches, if the guards let it pass."""
        await _guard(_policy_for(self, scope), super().handle, scope, receive, send)


class GuardedPage(Route):
    """A page, behind the guards.

    Attributes:
        policy: that of its endpoint.
    """

    def __init__(
        self,
        path: str,
        endpoint: Callable[..., Any],
        policy: RoutePolicy | None = None,
        **options: Any,
    ) -> None:
        """Create a route.

        Args:
            path: of the page.
            endpoint: answers its requests.
            policy: of the page; None for that on the endpoint.
            options: further arguments of `Route`.

        Raises:
            MissingPolicy: if there is no policy.
        """
        self.policy = _policy_on(endpoint, path) if policy is None else policy
        super().__init__(path, endpoint, **options)

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request that matches, if the guards let it pass."""
        await _guard(_policy_for(self, scope), super().handle, scope, receive, send)


class GuardedFiles(Mount):
    """A folder of files, behind the guards.

    Attributes:
        policy: of reading its files.
    """

    def __init__(
        self, path: str, app: ASGIApp, policy: RoutePolicy, name: str | None = None
    ) -> None:
        """Serve an app, such as static files, below a path."""
        self.policy = policy
        super().__init__(path, app, name=name)

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request that matches, if the guards let it pass."""
        is_read = scope["method"] in READ_METHODS
        of_request = self.policy if is_read else policy_without_route(scope)
        await _guard(of_request, super().handle, scope, receive, send)


def _policy_for(route: GuardedRoute | GuardedPage, scope: Scope) -> RoutePolicy:
    """Return the policy of a request that matches a route by its path."""
    has_method = route.methods is None or scope["method"] in route.methods
    return route.policy if has_method else policy_without_route(scope)


def api_router(**options: Any) -> APIRouter:
    """Return a router whose routes are behind the guards; arguments as of `APIRouter`.

    The name of a route is its operation id, such as `start_race`.
    """
    return APIRouter(route_class=GuardedRoute, generate_unique_id_function=operation_id, **options)


def operation_id(route: APIRoute) -> str:
    """Return the operation id of a route: its name, a verb and a noun, which is that of no other.

    Generators of clients make the names of functions from it.
    """
    return route.name


class _WithoutRoute:
    """Answers requests for which there is no route, behind the guards: a redirect, or 404."""

    def __init__(self, router: APIRouter) -> None:
        self._router = router

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        await _guard(policy_without_route(scope), self._answer, scope, receive, send)

    async def _answer(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Redirect to the path with or without its last slash if it is a route's, as Starlette."""
        if path_of(scope) != "/":
            path = scope["path"]
            other = path.rstrip("/") if path.endswith("/") else f"{path}/"
            routes = self._router.routes
            if any(r.matches({**scope, "path": other})[0] is not Match.NONE for r in routes):
                await RedirectResponse(_relative(path, other, scope))(scope, receive, send)
                return
        await self._router.not_found(scope, receive, send)


def _relative(path: str, other: str, scope: Scope) -> str:
    """Return the address of a path with or without its last slash, relative to this path.

    So it is valid behind a proxy that serves the app under a prefix.
    """
    up = "../" * (len(path) - len(path.rstrip("/"))) or "./"
    query = scope["query_string"].decode("latin-1")
    name = quote(other.rstrip("/").rpartition("/")[2]) + ("/" if other.endswith("/") else "")
    return f"{up}{name}{'?' if query else ''}{query}"


def guard_everything(app: FastAPI, guards: Guards) -> None:
    """Put all that an app answers behind guards, also paths without a route.

    Args:
        app: the app, with all its routes.
        guards: called for each request.

    Raises:
        MissingPolicy: if a route of the app has none, or is not behind the guards.
    """
    app.state.guards = guards
    app.router.route_class = GuardedRoute
    app.router.redirect_slashes = False
    app.router.default = _WithoutRoute(app.router)
    for context in iter_route_contexts(app.routes):
        if not _is_guarded(context.original_route, app):
            raise MissingPolicy(context.path or "/")


def _is_guarded(route: BaseRoute, app: FastAPI) -> bool:
    if isinstance(route, GuardedRoute):
        return True
    # FastAPI serves copies of other routes of a router that is included, which are not guarded.
    is_page = isinstance(route, (GuardedPage, GuardedFiles))
    return is_page and any(route is route_ for route_ in app.routes)


def policies(app: FastAPI) -> dict[tuple[str, str], RoutePolicy]:
    """Return the policies of all routes, by method in lower case and path."""
    by_operation: dict[tuple[str, str], RoutePolicy] = {}
    for context in iter_route_contexts(app.routes):
        route = context.original_route
        if isinstance(route, GuardedFiles):
            by_operation["get", route.path] = route.policy
        elif isinstance(route, (GuardedRoute, GuardedPage)):
            path = context.path_format or route.path
            by_operation |= {(method.lower(), path): route.policy for method in route.methods or ()}
    return by_operation
