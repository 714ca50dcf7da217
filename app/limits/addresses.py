"""Group client addresses, so that one client cannot pose as many by changing its address."""

import ipaddress

from starlette.types import Scope


def client_group(host: str) -> str:
    """Return an IPv4 address unchanged, and the /64 network of an IPv6 address.

    A /64 is usually assigned to one client, which can use all of its addresses.
    """
    try:
        address = ipaddress.ip_address(host)
    except ValueError:
        return host
    if isinstance(address, ipaddress.IPv6Address):
        if address.ipv4_mapped is not None:
            return str(address.ipv4_mapped)
        return str(ipaddress.ip_network((address, 64), strict=False))
    return host


def client_of(scope: Scope) -> str:
    """Return the client group of a request; behind a trusted proxy, of the forwarded address."""
    return client_group(scope["client"][0] if scope.get("client") else "")
