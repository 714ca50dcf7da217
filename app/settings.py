"""Settings of a server: from the environment, overruled by options, checked before anything starts.

Every name is `HEXAPODS_…`; an empty variable counts as none, since that is how compose files
leave one out.
"""

import ctypes
import ipaddress
import os
import re
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, Literal, get_args
from urllib.parse import urlsplit

import platformdirs

from hexapods.domain.errors import InvalidInput, UnknownName

Spectators = Literal["public", "token"]
LogLevel = Literal["debug", "info", "warning", "error"]

PREFIX = "HEXAPODS_"
ROBOTS_FOLDER = "robots"
"""In the data folder: documents of stored robots, in a folder for each database."""
MIN_QUOTA_MB = 10
MAX_PORT = 65535
_CHOICES = {"spectators": get_args(Spectators), "log_level": get_args(LogLevel)}
_WHOLE_NUMBERS = {
    "quota_mb": (MIN_QUOTA_MB, None, " of megabytes"),
    "starts_per_minute": (1, None, ""),
    "what_ifs_per_minute": (1, None, ""),
    "max_connections": (1, None, ""),
    "max_connections_per_address": (1, None, ""),
    "job_niceness": (0, 19, ""),
    "max_viewers": (1, None, ""),
    "demo_steps_per_hour": (1, None, " of steps"),
    "demo_hours": (1, 24, " of hours"),
}
"""By setting the least, the most if there is one, and of what."""
_YES, _NO = ("1", "true", "yes", "on"), ("0", "false", "no", "off")
_DEMO_DEFAULTS: Mapping[str, Any] = {
    "starts_per_minute": 120,
    "what_ifs_per_minute": 20,
    "max_viewers": 200,
    "quota_mb": 4000,
}
"""What is stricter on a demo unless it is given: strangers are there, of whom a class may share an
address."""
MIN_TOKEN_LENGTH, MAX_TOKEN_LENGTH = 16, 200
_TOKEN = re.compile(rf"[\x21-\x7e]{{{MIN_TOKEN_LENGTH},{MAX_TOKEN_LENGTH}}}")
_HOST_NAME = re.compile(r"(?=.{1,253}$)[a-z0-9_]([a-z0-9_-]*[a-z0-9_])?(\.[a-z0-9_-]+)*")


@dataclass(frozen=True, kw_only=True)
class Settings:
    """Settings of a server, complete and checked.

    Attributes:
        host: address to bind, by number or name.
        port: to bind; 0 lets the system choose.
        data: the data folder; made if it is not there.
        token: makes its bearer an operator; None makes everyone one, which is only allowed on
            loopback.
        spectators: `public` lets anyone watch, `token` only who has the token.
        public_url: where a proxy offers the server, such as `https://hexapods.example`.
        allowed_hosts: further host names by which the server may be called.
        trusted_proxies: addresses and networks of the proxies whose `X-Forwarded-For` and
            `X-Forwarded-Proto` are believed; of other clients these headers are ignored.
        database_url: of a PostgreSQL database, which may hold a password; None for SQLite in the
            data folder.
        max_connections: how many may be open at once; None for as many as the limit of open files
            allows beside the server's own.
        max_connections_per_address: of these, how many one address may have; None for half.
        starts_per_minute: how often one address may start something that costs the machine work.
        what_ifs_per_minute: how many what-ifs the spectators of one address may ask; operators may
            ask any number.
        job_niceness: by how much the priority of jobs is lower than the server's own, 0 to 19.
        log_level: below which records are left out of the log.
        quota_mb: how much the data folder may take, in MB; None for as much as the disk has.
        max_viewers: how many may watch the stage at once, and as many may follow the events.
        without: names of the features that are left out.
        demo: whether strangers may train, within an allowance, what is deleted after a day.
        demo_steps_per_hour: how many steps a visitor of a demo may compute in an hour.
        demo_hours: after how many hours what a visitor of a demo has made is deleted.
    """

    host: str = "127.0.0.1"
    port: int = 8000
    data: Path
    token: str | None = field(default=None, repr=False)
    spectators: Spectators = "public"
    public_url: str | None = None
    allowed_hosts: tuple[str, ...] = ()
    trusted_proxies: tuple[str, ...] = ()
    database_url: str | None = field(default=None, repr=False)
    quota_mb: int | None = None
    max_connections: int | None = None
    max_connections_per_address: int | None = None
    starts_per_minute: int = 1200
    what_ifs_per_minute: int = 30
    job_niceness: int = 15
    max_viewers: int = 300
    log_level: LogLevel = "info"
    without: tuple[str, ...] = ()
    demo: bool = False
    demo_steps_per_hour: int = 20_000
    demo_hours: int = 24

    def __post_init__(self) -> None:
        if isinstance(self.port, bool) or not 0 <= self.port <= MAX_PORT:
            raise _invalid_port(self.port)
        if self.token is not None and not _TOKEN.fullmatch(self.token):
            raise InvalidInput(
                f"{PREFIX}TOKEN must have {MIN_TOKEN_LENGTH} to {MAX_TOKEN_LENGTH} printable ASCII "
                "characters and no spaces; `openssl rand -hex 16` makes a good one"
            )
        for name, choices in _CHOICES.items():
            if getattr(self, name) not in choices:
                raise UnknownName(PREFIX + name.upper(), getattr(self, name), choices)
        if self.public_url is not None:
            _check_url(self.public_url)
        for name in self.allowed_hosts:
            _check_host(name)
        for name in self.trusted_proxies:
            _check_network(name)
        if self.database_url is not None:
            _check_database_url(self.database_url)
        self._check_numbers()
        self._check_demo()
        if self.token is None and not is_loopback(self.host):
            raise InvalidInput(
                f"refusing to listen on {self.host} without a token, since anyone there could "
                f"start and delete runs: set {PREFIX}TOKEN, use --share, or bind 127.0.0.1"
            )

    def _check_numbers(self) -> None:
        for name, (least, most, _) in _WHOLE_NUMBERS.items():
            number = getattr(self, name)
            if number is None or (number >= least and (most is None or number <= most)):
                continue
            limits = f"at least {least}" if most is None else f"from {least} to {most}"
            raise InvalidInput(f"{PREFIX}{name.upper()} must be {limits}, not {number}")

    def _check_demo(self) -> None:
        if not self.demo:
            return
        if "demo" in self.without:
            raise InvalidInput(
                f"{PREFIX}DEMO is on, and {PREFIX}WITHOUT leaves the demo out, so that nothing "
                "that strangers make would be deleted; take one of both back"
            )
        if self.token is None:
            raise InvalidInput(
                f"a demo needs {PREFIX}TOKEN, or every stranger would be its operator; "
                "`openssl rand -hex 16` makes a good one"
            )
        if self.spectators != "public":
            raise InvalidInput(
                f"a demo is open to strangers: leave {PREFIX}SPECTATORS out, or leave out "
                f"{PREFIX}DEMO"
            )

    @property
    def viewers_per_address(self) -> int:
        """Maximum of them per address: many, as a class may share one, but not all."""
        return max(1, self.max_viewers * 4 // 5)

    @property
    def public_host(self) -> str | None:
        """The host name in `public_url`, in lower case."""
        return None if self.public_url is None else urlsplit(self.public_url).hostname

    @property
    def public_origin(self) -> str | None:
        """The origin of `public_url`, as browsers send it."""
        if self.public_url is None:
            return None
        parts = urlsplit(self.public_url)
        return f"{parts.scheme}://{parts.netloc.lower()}"

    @property
    def proxy_networks(self) -> list[str]:
        """The networks of `trusted_proxies`, those of IPv4 as an IPv6 socket names them, too."""
        networks = [ipaddress.ip_network(name) for name in self.trusted_proxies]
        mapped = [
            f"::ffff:{network.network_address}/{96 + network.prefixlen}"
            for network in networks
            if network.version == 4
        ]
        return [*map(str, networks), *mapped]

    def prepare_data(self) -> None:
        """Make the data folder, closed to other users, and make sure that it can be written.

        Raises:
            InvalidInput: if it cannot.
        """
        try:
            self.data.parent.mkdir(parents=True, exist_ok=True)
            self.data.mkdir(mode=0o700, exist_ok=True)
            with tempfile.TemporaryFile(dir=self.data):
                pass
        except OSError as error:
            raise InvalidInput(
                f"cannot write to the data folder {self.data} ({error.strerror}); choose one "
                f"that can be written with --data or {PREFIX}DATA"
            ) from error


def read_settings(environ: Mapping[str, str] = os.environ, **options: Any) -> Settings:
    """The settings of an environment; an option that is not None goes before its variable.

    Args:
        environ: the environment.
        options: the attributes of `Settings`, by their names.

    Raises:
        InvalidInput: for a value that cannot be, or a refusal to start with it.
    """
    names = [attribute.name for attribute in fields(Settings)]
    given: dict[str, Any] = {name: environ.get(PREFIX + name.upper()) or None for name in names}
    given |= {name: value for name, value in options.items() if value is not None}
    given = {name: value for name, value in given.items() if value is not None}
    if isinstance(given.get("demo"), str):
        given["demo"] = _yes_or_no("demo", given["demo"])
    if given.get("demo"):
        given = {**_DEMO_DEFAULTS, **given}
    if isinstance(given.get("port"), str):
        given["port"] = _port(given["port"])
    for name, (_, _, what) in _WHOLE_NUMBERS.items():
        if isinstance(given.get(name), str):
            given[name] = _whole_number(name, what, given[name])
    for name in ("allowed_hosts", "trusted_proxies"):
        if isinstance(given.get(name), str):
            hosts = given[name].lower().split(",")
            given[name] = tuple(host.strip() for host in hosts if host.strip())
    if isinstance(given.get("without"), str):
        given["without"] = _names(given["without"])
    data = given.pop("data", None) or platformdirs.user_data_path("racing-hexapods", False)
    return Settings(data=Path(data).expanduser().absolute(), **given)


def read_without(environ: Mapping[str, str] = os.environ) -> tuple[str, ...]:
    """Return the names of the features that an environment leaves out."""
    return _names(environ.get(f"{PREFIX}WITHOUT", ""))


def is_demo(environ: Mapping[str, str] = os.environ) -> bool:
    """Whether an environment makes a server a demo; errors as `read_settings`."""
    return _yes_or_no("demo", environ.get(f"{PREFIX}DEMO") or _NO[0])


def remove_secrets() -> None:
    """Remove the token and the database's URL from the environment, for this process's children.

    Their memory is overwritten: a fork has a copy of it, which `/proc/PID/environ` shows.
    """
    for secret in (one.name for one in fields(Settings) if not one.repr):
        name = PREFIX + secret.upper()
        if name not in os.environ:
            continue
        if sys.platform != "win32":
            library = ctypes.CDLL(None)
            library.getenv.restype = ctypes.c_void_p
            if address := library.getenv(name.encode()):
                ctypes.memset(address, 0, len(os.environb[name.encode()]))
        del os.environ[name]


def is_loopback(host: str) -> bool:
    """Whether only this machine can reach what listens there."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False


def _names(text: str) -> tuple[str, ...]:
    return tuple(filter(None, map(str.strip, text.split(","))))


def _port(text: str) -> int:
    if not text.isascii() or not text.isdigit():
        raise _invalid_port(text)
    return int(text)


def _invalid_port(given: int | str) -> InvalidInput:
    return InvalidInput(f"the port must be from 0 to {MAX_PORT}, not {given!r}")


def _whole_number(name: str, what: str, text: str) -> int:
    if not text.isascii() or not text.isdigit():
        raise InvalidInput(f"{PREFIX}{name.upper()} must be a whole number{what}, not {text!r}")
    return int(text[:18])


def _yes_or_no(name: str, text: str) -> bool:
    if text.lower() not in (*_YES, *_NO):
        raise InvalidInput(f"{PREFIX}{name.upper()} must be 1 or 0, not {text!r}")
    return text.lower() in _YES


def _check_host(name: str) -> None:
    if not _HOST_NAME.fullmatch(name):
        raise InvalidInput(
            f"{PREFIX}ALLOWED_HOSTS must be host names separated by commas, without "
            f"scheme, port or star; {name!r} is none"
        )


def _check_network(name: str) -> None:
    try:
        ipaddress.ip_network(name)
    except ValueError as error:
        raise InvalidInput(
            f"{PREFIX}TRUSTED_PROXIES must be addresses or networks separated by commas, such as "
            f"127.0.0.1 or 172.16.0.0/12; {name!r} is none"
        ) from error


def _check_database_url(url: str) -> None:
    """The URL itself is in no message, since it may hold a password."""
    try:
        parts = urlsplit(url)
        good = (
            parts.scheme in ("postgresql", "postgres") and parts.path.strip("/") and parts.port != 0
        )
    except ValueError:
        good = False
    if not good:
        raise InvalidInput(
            f"{PREFIX}DATABASE_URL must look like postgresql://user:password@host/database; "
            "without it, SQLite in the data folder is used"
        )


def _check_url(url: str) -> None:
    try:
        parts = urlsplit(url)
        good = parts.scheme in ("http", "https") and parts.hostname and parts.port != 0
    except ValueError:
        good = False
    if not good or parts.username or parts.path.strip("/") or parts.query or parts.fragment:
        raise InvalidInput(
            f"{PREFIX}PUBLIC_URL must look like https://hexapods.example, without path, not {url!r}"
        )
