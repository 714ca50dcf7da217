"""Client addresses, grouped so that one client cannot count as many."""

import ipaddress

from starlette.types import Scope


def client_group(host: str) -> str:
    """An IPv4 address as it is, a network of IPv6: whoever has one there has all of the network."""
    try:
        address = ipaddress.ip_address(host)
    except ValueError:
        return host
    if isinstance(address, ipaddress.IPv6Address):
        if address.ipv4_mapped is not None:
            return str(address.ipv4_mapped)
        return str(ipaddress.ip_network((address, 64), strict=False))
    return host


def caller(scope: Scope) -> str:
    """The client group of a request, as the proxy before the server says where it is believed."""
    return client_group(scope["client"][0] if scope.get("client") else "")
