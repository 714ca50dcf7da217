"""Checks of settings that are texts: tokens, names of hosts, networks and URLs.

Each takes the variable of the setting and a text, and raises InvalidInput if that is not valid.
"""

import ipaddress
import re
from urllib.parse import urlsplit

from hexapods.domain.errors import InvalidInput

MIN_TOKEN_LENGTH, MAX_TOKEN_LENGTH = 16, 200
_TOKEN = re.compile(rf"[\x21-\x7e]{{{MIN_TOKEN_LENGTH},{MAX_TOKEN_LENGTH}}}")
_ORIGIN = re.compile(r"https?://[^/?#@\s]+")
PUBLIC_PATH = r"(?=.{2,200}$)(/(?!\.+(/|$))[A-Za-z0-9._~@+-]+)+"
"""Regular expression of the path of a public URL, without a slash at its end."""
_HOST_NAME = re.compile(r"(?=.{1,253}$)[a-z0-9_]([a-z0-9_-]*[a-z0-9_])?(\.[a-z0-9_-]+)*")


def check_token(variable: str, token: str) -> None:
    """Check an access token, which is in no message."""
    if not _TOKEN.fullmatch(token):
        raise InvalidInput(
            f"{variable} must have {MIN_TOKEN_LENGTH} to {MAX_TOKEN_LENGTH} printable ASCII "
            "characters and no spaces; `openssl rand -hex 16` makes a good one"
        )


def check_host_name(variable: str, name: str) -> None:
    """Check one of the host names of a list."""
    if not _HOST_NAME.fullmatch(name):
        raise InvalidInput(
            f"{variable} must be host names separated by commas, without "
            f"scheme, port or star; {name!r} is none"
        )


def check_origin(variable: str, origin: str) -> None:
    """Check one of the origins of a list, in lower case."""
    try:
        parts = urlsplit(origin)
        is_valid = (
            _ORIGIN.fullmatch(origin) is not None
            and _HOST_NAME.fullmatch(parts.hostname or "") is not None
            and parts.port != 0
        )
    except ValueError:
        is_valid = False
    if not is_valid:
        raise InvalidInput(
            f"{variable} must be origins separated by commas, such as "
            f"https://portal.school.example or http://localhost:8080, with neither path nor star; "
            f"{origin!r} is none"
        )


def check_network(variable: str, name: str) -> None:
    """Check one of the addresses and networks of a list."""
    try:
        ipaddress.ip_network(name)
    except ValueError as error:
        raise InvalidInput(
            f"{variable} must be addresses or networks separated by commas, such as "
            f"127.0.0.1 or 172.16.0.0/12; {name!r} is none"
        ) from error


def check_database_url(variable: str, url: str) -> None:
    """Check the URL of a PostgreSQL database, which is in no message: it may hold a password."""
    try:
        parts = urlsplit(url)
        is_valid = (
            parts.scheme in ("postgresql", "postgres") and parts.path.strip("/") and parts.port != 0
        )
    except ValueError:
        is_valid = False
    if not is_valid:
        raise InvalidInput(
            f"{variable} must look like postgresql://user:password@host/database; "
            "without it, SQLite in the data folder is used"
        )


def check_public_url(variable: str, url: str) -> None:
    """Check the URL at which a proxy offers a server: an origin, or one with a path."""
    try:
        parts = urlsplit(url)
        is_valid = parts.scheme in ("http", "https") and parts.hostname and parts.port != 0
    except ValueError:
        is_valid = False
    if not is_valid or parts.username or parts.query or parts.fragment:
        raise InvalidInput(
            f"{variable} must look like https://hexapods.example or, below a path, "
            f"https://school.example/hex/, not {url!r}"
        )
    path = parts.path.removesuffix("/")
    if path and not re.fullmatch(PUBLIC_PATH, path):
        raise InvalidInput(
            f"{variable} may have a path such as /hex/ or /user/ada/proxy/8000/, of letters, "
            f"digits and . _ ~ @ + - between single slashes, not {parts.path!r}"
        )
    if path and not parts.path.endswith("/"):
        raise InvalidInput(f"{variable} must end with a slash after its path: {url}/")
