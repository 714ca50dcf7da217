"""Client of the running server that holds the data folder's lock."""

import json
import urllib.error
import urllib.request
from collections.abc import Mapping
from typing import Any

from app.setting_fields import PREFIX
from app.settings import Settings
from app.storage.server_lock import read_address_file
from hexapods.domain.errors import InvalidInput

_TIMEOUT_S = 60.0


class NoServer(InvalidInput):
    """No server answers for the data folder."""


def call_server(
    settings: Settings,
    method: str,
    path: str,
    body: bytes | Mapping[str, Any] | None = None,
    media_type: str = "application/octet-stream",
) -> Any:
    """Send a request to the server of the data folder, and return its decoded JSON response.

    Args:
        settings: data folder, and token if the server needs one.
        method: HTTP method.
        path: path without its leading slash.
        body: body of the request, if any; a mapping is sent as JSON.
        media_type: of a body of bytes.

    Raises:
        NoServer: if it does not respond.
        InvalidInput: if it refuses.
    """
    if body is not None and not isinstance(body, bytes):
        body, media_type = json.dumps(body).encode(), "application/json"
    data = _request(settings, method, path, body, media_type)
    return json.loads(data) if data else None


def fetch_from_server(settings: Settings, path: str) -> bytes:
    """Return a file of the server of the data folder; arguments and errors as of `call_server`."""
    return _request(settings, "GET", path)


def _request(
    settings: Settings, method: str, path: str, body: bytes | None = None, media_type: str = ""
) -> bytes:
    address = read_address_file(settings.data)
    if address is None:
        raise NoServer(
            f"another process has the data folder {settings.data}, and does not say where it "
            "listens; try again in a moment, or once it has ended if it is a command with --keep"
        )
    headers = {"Content-Type": media_type} if body is not None else {}
    if settings.token is not None:
        headers["Authorization"] = f"Bearer {settings.token}"
    request = urllib.request.Request(  # noqa: S310 - the address file's URL is validated
        address + path, body, headers, method=method
    )
    # Without the proxies of the environment, as the server is on this machine.
    opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
    try:
        with opener.open(request, timeout=_TIMEOUT_S) as answer:
            data: bytes = answer.read()
    except urllib.error.HTTPError as error:
        with error:
            raise InvalidInput(_refusal(address, error)) from error
    except OSError as error:
        raise NoServer(
            f"the server that has the data folder {settings.data} does not answer at {address}; "
            "look at its log, or stop it"
        ) from error
    return data


def _refusal(address: str, error: urllib.error.HTTPError) -> str:
    if error.code == 401:
        return (
            f"the server at {address}, which has the data folder, needs its token: set "
            f"{PREFIX}TOKEN to it"
        )
    try:
        detail = str(json.loads(error.read())["detail"])
    except (ValueError, KeyError, TypeError):
        detail = f"it answers {error.code}"
    return f"the server at {address}, which has the data folder, refuses: {detail}"
