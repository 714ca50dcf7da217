"""Settings of a server: from the environment, overruled by options, checked before anything starts.

Every name is `HEXAPODS_…`; an empty variable counts as none, since that is how compose files
leave one out. Those of the core are declared here as those of features are in their folders
(`feature_settings`): as fields of kinds that `setting_fields` has.
"""

import ctypes
import ipaddress
import os
import sys
import tempfile
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, fields
from itertools import chain
from pathlib import Path
from typing import Any, Literal, TypeVar, get_args
from urllib.parse import urlsplit

import platformdirs

from app.feature_settings import FeatureSettings, installed_settings
from app.setting_checks import (
    check_database_url,
    check_host_name,
    check_network,
    check_origin,
    check_public_url,
    check_token,
)
from app.setting_fields import (
    PREFIX,
    check_kinds,
    choice,
    names,
    read_texts,
    text,
    variable_of,
    whole_number,
)
from hexapods.domain.errors import InvalidInput

Spectators = Literal["public", "token"]
LogLevel = Literal["debug", "info", "warning", "error"]
S = TypeVar("S", bound=FeatureSettings)

ROBOTS_FOLDER = "robots"
"""In the data folder: documents of stored robots, in a folder for each database."""
MIN_QUOTA_MB = 10
MAX_PORT = 65535


@dataclass(frozen=True, kw_only=True)
class Settings:
    """Settings of a server, complete and checked.

    Attributes:
        host: address to bind, by number or name.
        port: TCP port to bind; 0 lets the system choose.
        data: the data folder; made if it is not there.
        token: makes its bearer an operator; None makes everyone one, which is only allowed on
            loopback.
        spectators: `public` lets anyone watch, `token` only clients with the token.
        public_url: address at which a proxy offers the server, such as `https://hexapods.example`,
            or `https://school.example/hex/` with a path.
        frame_ancestors: origins whose pages may have the server's in a frame, beside its own.
        allowed_hosts: further host names by which the server may be called.
        cors_origins: origins of other pages whose scripts may call the API, as who has the token.
        trusted_proxies: addresses and networks of the proxies whose `X-Forwarded-For` and
            `X-Forwarded-Proto` are believed; of other clients these headers are ignored.
        database_url: URL of a PostgreSQL database, which may hold a password; None for SQLite in
            the data folder.
        max_connections: maximum number of open connections; None for as many as the limit of open
            files allows beside the server's own.
        max_connections_per_address: maximum number of these of one address; None for half.
        starts_per_minute: maximum rate at which one address may start work, such as runs.
        job_niceness: by how much the priority of jobs is lower than the server's own, 0 to 19.
        log_level: level below which records are left out of the log.
        quota_mb: maximum size of the data folder, in MB; None for as much as the disk has.
        max_viewers: maximum number of streams of events, and so of pages that watch.
        without: names of the features that are left out.
        features: settings of features, of those that are left out, too.
    """

    host: str = text("127.0.0.1")
    port: int = whole_number(8000, 0, MAX_PORT)
    data: Path
    token: str | None = text(None, check_token, is_secret=True)
    spectators: Spectators = choice("public", get_args(Spectators))
    public_url: str | None = text(None, check_public_url)
    frame_ancestors: tuple[str, ...] = names(check_origin, ignores_case=True)
    allowed_hosts: tuple[str, ...] = names(check_host_name, ignores_case=True)
    cors_origins: tuple[str, ...] = names(check_origin, ignores_case=True)
    trusted_proxies: tuple[str, ...] = names(check_network, ignores_case=True)
    database_url: str | None = text(None, check_database_url, is_secret=True)
    quota_mb: int | None = whole_number(None, MIN_QUOTA_MB, unit=" of megabytes")
    max_connections: int | None = whole_number(None, 1)
    max_connections_per_address: int | None = whole_number(None, 1)
    starts_per_minute: int = whole_number(1200, 1)
    job_niceness: int = whole_number(15, 0, 19)
    max_viewers: int = whole_number(300, 1)
    log_level: LogLevel = choice("info", get_args(LogLevel))
    without: tuple[str, ...] = names()
    features: tuple[FeatureSettings, ...] = ()

    def __post_init__(self) -> None:
        check_kinds(self)
        for settings in self.features:
            if settings.feature in self.without:
                settings.check_left_out()
            else:
                settings.check(self)
        if self.token is None and not is_loopback(self.host):
            raise InvalidInput(
                f"refusing to listen on {self.host} without a token, since anyone there could "
                f"start and delete runs: set {PREFIX}TOKEN, use --share, or bind 127.0.0.1"
            )

    def of(self, kind: type[S]) -> S:
        """Return the settings of a feature by their class; its defaults if there are none."""
        return next((values for values in self.features if isinstance(values, kind)), kind())

    @property
    def viewers_per_address(self) -> int:
        """Maximum number of viewers per address: many, as a class may share one, but not all."""
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
    def has_https(self) -> bool:
        """Whether `public_url` is an HTTPS address."""
        return (self.public_url or "").startswith("https:")

    @property
    def public_path(self) -> str:
        """The path of `public_url`, without a slash at its end; "" without one."""
        return "" if self.public_url is None else urlsplit(self.public_url).path.rstrip("/")

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
    """Return the settings of an environment; an option that is not None overrules its variable.

    Args:
        environ: the environment.
        options: the attributes of `Settings` and of the settings of features, by their names.

    Raises:
        InvalidInput: if a value is not valid, or the server refuses to start with it.
    """
    features, without = read_feature_settings(environ, **options), _without(environ, options)
    of_core = {declared.name for declared in fields(Settings)}
    of_features = {declared.name for settings in features for declared in fields(settings)}
    values_set = _values_set(
        (of_core | options.keys()) - of_features - {"features"}, environ, options
    )
    stricter = _stricter_defaults(features, without)
    values = {name: value for name, value in stricter.items() if name in of_core} | values_set
    values |= read_texts(Settings, values)
    data = values.pop("data", None) or platformdirs.user_data_path("racing-hexapods", False)
    return Settings(data=Path(data).expanduser().absolute(), features=features, **values)


def read_feature_settings(
    environ: Mapping[str, str] = os.environ, **options: Any
) -> tuple[FeatureSettings, ...]:
    """Return the settings of all features alone; arguments and errors as of `read_settings`."""
    without = _without(environ, options)
    kinds = _kinds_of_features(without)
    of_features = {declared.name for kind in kinds for declared in fields(kind)}
    values_set = _values_set(of_features, environ, options)

    def read(defaults: Mapping[str, Any]) -> tuple[FeatureSettings, ...]:
        return tuple(kind(**read_texts(kind, {**defaults, **values_set})) for kind in kinds)

    return read(_stricter_defaults(read({}), without))


def _kinds_of_features(without: Collection[str]) -> list[type[FeatureSettings]]:
    """Return the classes of the settings of features.

    Raises:
        InvalidInput: if a setting of one is there already.
    """
    declared_names = {declared.name for declared in fields(Settings)}
    kinds = []
    for kind in installed_settings(without):
        added = {declared.name for declared in fields(kind)}
        if twice := sorted(declared_names & added):
            if kind.feature in without:
                continue
            raise InvalidInput(
                f"the feature {kind.feature} has the setting {variable_of(twice[0])}, which is "
                f"there already; leave {kind.feature} out by {PREFIX}WITHOUT"
            )
        declared_names |= added
        kinds.append(kind)
    return kinds


def _values_set(
    setting_names: Collection[str], environ: Mapping[str, str], options: Mapping[str, Any]
) -> dict[str, Any]:
    """Return the values of these settings that are set, by name: options before variables."""
    texts = {name: value for name in setting_names if (value := environ.get(variable_of(name)))}
    return texts | {
        name: value
        for name, value in options.items()
        if name in setting_names and value is not None
    }


def _without(environ: Mapping[str, str], options: Mapping[str, Any]) -> tuple[str, ...]:
    values = read_texts(Settings, _values_set(["without"], environ, options))
    return tuple(values.get("without", ()))


def _stricter_defaults(
    features: Iterable[FeatureSettings], without: Collection[str]
) -> dict[str, Any]:
    return {
        name: value
        for feature in features
        if feature.feature not in without
        for name, value in feature.stricter_defaults().items()
    }


def read_without(environ: Mapping[str, str] = os.environ) -> tuple[str, ...]:
    """Return the names of the features that an environment leaves out."""
    return _without(environ, {})


def remove_secrets() -> None:
    """Remove settings that `repr` hides from the environment, for this process's children.

    Their memory is overwritten: a fork has a copy of it, which `/proc/PID/environ` shows.
    """
    declared = [*fields(Settings), *chain(*map(fields, installed_settings(read_without())))]
    for name in (variable_of(setting.name) for setting in declared if not setting.repr):
        if name not in os.environ:
            continue
        if sys.platform != "win32":
            library = ctypes.CDLL(None)
            library.getenv.restype = ctypes.c_void_p
            if address := library.getenv(name.encode()):
                ctypes.memset(address, 0, len(os.environb[name.encode()]))
        del os.environ[name]


def is_loopback(host: str) -> bool:
    """Whether a host is a loopback address, which only this machine can reach."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False
