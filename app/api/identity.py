"""Identities: clients who are no operators, but whom a feature identifies, as by a cookie.

Such a feature has an `IdentityProvider`, which the guards call for each client who is no operator.
An identity decides what it may do beyond a spectator, or may not, by the access of the route and
the parameters of the request.
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
        """Role of the client, by which its pages show the permitted actions."""
        ...

    def allowance_key(self, scope: Scope) -> str | None:
        """Return the key of the allowance that a request is charged to; None for its address's."""
        ...

    def refusal(self, scope: Scope, access: Access, as_spectator: ASGIApp | None) -> ASGIApp | None:
        """Return the refusal of a request; None if it is allowed.

        Args:
            scope: ASGI scope of the request, with the parameters of its path.
            access: access of its route.
            as_spectator: refusal that a spectator would get; None if a spectator may do it.
        """
        ...


class IdentityProvider(Protocol):
    """Identifies clients who are no operators."""

    @property
    def scheme(self) -> tuple[str, Mapping[str, Any]]:
        """Name of its security scheme in the API's description, and its definition."""
        ...

    def identify(self, scope: Scope) -> Identity | None:
        """Return the identity of a client; None if this provider does not know the client.

        On a server without a token it is called for each client; those with an identity are no
        operators there.
        """
        ...

    def requirements(self, access: Access) -> list[dict[str, list[str]]]:
        """Return the security requirements of routes of an access, beside those for operators.

        As in OpenAPI they are alternatives: each names schemes; an empty one requires nothing.
        """
        ...


def charged_client(scope: Scope) -> str:
    """Return the key of the allowance that a request is charged to, of identity or address.

    Many clients with identities may share an address.
    """
    identity: Identity | None = scope["state"]["identity"]
    key = None if identity is None else identity.allowance_key(scope)
    return client_of(scope) if key is None else key


def run_ids_of(scope: Scope) -> Iterator[str]:
    """Yield all possible ids of runs in a request: `run_id` of the path, values of the query."""
    run_id = scope.get("path_params", {}).get("run_id")
    if run_id is not None:
        yield str(run_id)
    for _, value in parse_qsl(scope["query_string"].decode("latin-1")):
        yield from (run_id.strip() for run_id in value.split(","))
