"""Identities: clients who are no operators, but of whom a feature knows more than that they watch.

A feature that knows people by a cookie has an `IdentityProvider`, which the guards ask of each
client who is no operator. What an identity may do beyond a spectator, or may not, it decides itself
by the access of the route and the parameters of the request.
"""

from collections.abc import Iterator, Mapping
from typing import Any, Protocol
from urllib.parse import parse_qsl

from starlette.types import ASGIApp, Scope

from app.api.policy import Access
from app.limits.addresses import client_of


class Identity(Protocol):
    """A client whom a feature knows."""

    @property
    def page_role(self) -> str:
        """Role of the client's pages, which show by it what the client can do."""
        ...

    def allowance_key(self, scope: Scope) -> str | None:
        """Return whose allowance a request is charged to; None to count as its address."""
        ...

    def refusal(self, scope: Scope, access: Access, as_spectator: ASGIApp | None) -> ASGIApp | None:
        """Return the refusal of a request; None if it is allowed.

        Args:
            scope: of the request, or of a websocket, with the parameters of its path.
            access: that of its route.
            as_spectator: refusal that a spectator would get; None if a spectator may do it.
        """
        ...


class IdentityProvider(Protocol):
    """Knows clients who are no operators."""

    @property
    def scheme(self) -> tuple[str, Mapping[str, Any]]:
        """Name of its security scheme in the API's description, and its definition."""
        ...

    def identify(self, scope: Scope) -> Identity | None:
        """Return who a client is; None if it is nobody whom this provider knows.

        Where nobody needs a token each client is asked about, and whoever is known is no operator.
        """
        ...

    def requirements(self, access: Access) -> list[dict[str, list[str]]]:
        """Return by what, beside an operator's credentials, a route of an access can be used.

        As security requirements of OpenAPI: each names schemes, and an empty one means nothing.
        """
        ...


def charged_client(scope: Scope) -> str:
    """Return whose allowance a request is charged to: an identity's, or that of an address.

    Many who are known by more than their address may share one.
    """
    identity: Identity | None = scope["state"]["identity"]
    key = None if identity is None else identity.allowance_key(scope)
    return client_of(scope) if key is None else key


def run_ids_of(scope: Scope) -> Iterator[str]:
    """Yield all that may be the id of a run: `run_id` of the path, and all values of the query."""
    run_id = scope.get("path_params", {}).get("run_id")
    if run_id is not None:
        yield str(run_id)
    for _, value in parse_qsl(scope["query_string"].decode("latin-1")):
        yield from (run_id.strip() for run_id in value.split(","))
