"""Route of the address at which others watch, with its QR code; used by `serve --share`, too."""

from collections.abc import Collection
from functools import cache, lru_cache
from typing import NamedTuple
from urllib.parse import urlsplit

import segno
from fastapi import Request

from app.answer import Answer, Count
from app.api.deps import ServicesDep, StageDep
from app.api.pages import languages_of
from app.api.policy import WATCH, api_router, policy
from app.api.reachable import machine_addresses, reachable_first, url_of, why_unreachable
from app.api.record_response import RecordResponse
from app.api.stage_paths import stage_of
from app.setting_fields import PREFIX
from app.settings import Settings, is_loopback
from hexapods.assets import static_dir

_NEEDS_TOKEN = (
    f"There is no address for everyone: watching needs the token ({PREFIX}SPECTATORS=token)."
)
_LOOPBACK_ONLY = (
    "Only this machine can open this page; to let others watch, start the server with "
    f"hexapods serve --share, or set {PREFIX}PUBLIC_URL."
)

router = api_router(prefix="/spectators", tags=["stage"])


class SpectatorsView(Answer):
    """Spectators' address with its QR code, or the reason why there is none.

    Attributes:
        qr_code: SVG image as a data URI.
    """

    address: str | None
    qr_code: str | None
    reason: str
    watching: Count


@router.get("", summary="Get the spectators' address and their number")
@policy(access=WATCH)
def get_spectators(
    request: Request, services: ServicesDep, shared: StageDep
) -> RecordResponse[SpectatorsView]:
    """Return the address at which others watch, or why there is none, and its QR code."""
    is_public = shared.roles.is_public
    address = address_for_others(request, services.settings) if is_public else None
    reason = why_none(services.settings) if is_public else _NEEDS_TOKEN
    spectators = SpectatorsView(
        address=address,
        qr_code=None if address is None else qr_image(address),
        reason=reason if address is None else "",
        watching=shared.viewers,
    )
    return RecordResponse(spectators)


def page_address(request: Request, settings: Settings, path: str) -> str:
    """Return the address of a page of this server: for others if they can reach the server.

    Args:
        request: of who asks.
        settings: of the server.
        path: of the page, with a slash before it.
    """
    address = address_for_others(request, settings) or str(request.base_url)
    return address.rstrip("/").removesuffix(stage_of(request.scope).path) + path


@cache
def _languages() -> Collection[str]:
    """Return the languages of the page, listed once, as rooms often ask for links."""
    return frozenset(languages_of(static_dir()))


class Link(NamedTuple):
    """Link to a page of this server.

    Attributes:
        address: of the page, for others if they can reach the server.
        qr_code: of the address, an SVG image as a data URI; None if phones cannot reach the server.
    """

    address: str
    qr_code: str | None


def link_to(request: Request, settings: Settings, path: str) -> Link:
    """Return the link to a page, in the language of the page that asks; see `page_address`."""
    address = page_address(request, settings, path)
    # Of a page that is not in English.
    language = request.headers.get("page-language", "")
    if language in _languages():
        address += f"?lang={language}"
    is_reachable = address_for_others(request, settings) is not None
    return Link(address, qr_image(address) if is_reachable else None)


@lru_cache(maxsize=64)
def qr_image(address: str) -> str:
    """Return the QR code of an address as a data URI."""
    return str(qr_code(address).svg_data_uri(border=2, light="#fff"))


def qr_code(address: str) -> segno.QRCode:
    """Return the QR code of an address."""
    return segno.make(address, micro=False)


def shared_addresses(settings: Settings, port: int) -> dict[str, str]:
    """Return the addresses of the page for other machines, the likeliest first.

    Args:
        settings: settings of the server.
        port: the port on which it listens.

    Returns:
        The interface of each address, with a slash at the end; an empty name where the
        settings have the address. Nothing where other machines reach none.
    """
    if settings.public_url is not None:
        return {f"{settings.public_url.rstrip('/')}/": ""}
    reachable = reachable_first(machine_addresses(settings.host))
    return {url_of(address.host, port): address.interface for address in reachable}


def why_none(settings: Settings) -> str:
    """Return why other machines reach no address of the server."""
    if is_loopback(settings.host):
        return _LOOPBACK_ONLY
    return why_unreachable(settings.host, machine_addresses(settings.host))


def address_for_others(request: Request, settings: Settings) -> str | None:
    """Return the address at which others reach the page; None if they cannot."""
    if settings.public_url is None:
        # The Host has been checked: by that name this client has reached the server.
        name = urlsplit(str(request.base_url)).hostname or ""
        if not is_loopback(name):
            return f"{str(request.base_url).rstrip('/')}/"
        if is_loopback(settings.host):
            return None
    return next(iter(shared_addresses(settings, request.scope["server"][1])), None)
