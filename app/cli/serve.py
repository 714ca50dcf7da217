"""`hexapods serve`: serve the dashboard, the API and the stage at one address."""

import inspect
import os
import secrets
import sys
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields
from functools import partial
from typing import Annotated, Any

from cyclopts import Parameter

from app.cli.options import Data, WholeNumber
from app.cli.program import without_garbage_collection
from app.cli.setting_options import flag
from app.feature_settings import installed_settings
from app.setting_fields import Switch, kind_of, variable_of
from app.settings import (
    Settings,
    is_loopback,
    read_feature_settings,
    read_settings,
    read_without,
    remove_secrets,
)
from hexapods.domain.errors import InvalidInput

THREADS_END_S = 2.0
"""Time for threads to end that still compute for requests once everything else has ended."""


@dataclass(frozen=True)
class _SwitchOptions:
    """An option for each setting of a feature that `hexapods serve` can turn on."""

    def parameters(self, words: Sequence[str] | None) -> Iterator[inspect.Parameter]:
        """Yield the parameters of the options."""
        del words
        for settings in installed_settings(read_without()):
            for declared in fields(settings):
                kind = kind_of(declared)
                if isinstance(kind, Switch) and kind.option is not None:
                    yield inspect.Parameter(
                        declared.name,
                        inspect.Parameter.KEYWORD_ONLY,
                        default=False,
                        annotation=Annotated[bool, Parameter(help=kind.option)],
                    )


def serve(
    *,
    host: str | None = None,
    port: WholeNumber | None = None,
    data: Data = None,
    share: bool = False,
    **switches: Annotated[bool, _SwitchOptions()],
) -> int:
    """Serve the dashboard, the API and the stage at one address, until stopped.

    Args:
        host: address to bind (default 127.0.0.1, or HEXAPODS_HOST)
        port: port to bind (default 8000, or HEXAPODS_PORT)
        share: let the local network watch: bind every address, make a token if none is set, print
            the links

    Raises:
        InvalidInput: if the server cannot start with these options.
    """
    options: dict[str, Any] = {"host": host, "port": port, "data": data}
    if share:
        options["host"] = host or "0.0.0.0"  # noqa: S104 - that is what --share is for
        options["token"] = read_token() or secrets.token_urlsafe(24)
    options |= switches
    with _naming_options(options):
        of_features = read_feature_settings(**options)
    # Of a token of the environment no link is printed unless it is asked for: it would be in a log.
    shows_links = share or any(
        settings.audience and any(switches.get(declared.name) for declared in fields(settings))
        for settings in of_features
    )
    needs_token = any(settings.needs_token for settings in of_features)
    if needs_token and "token" not in options and read_token() is None:
        bound = host or os.environ.get("HEXAPODS_HOST") or Settings.host
        if is_loopback(bound):
            options["token"], shows_links = secrets.token_urlsafe(24), True
    with _naming_options(options):
        settings = read_settings(**options)
    remove_secrets()  # no process that is started from here on needs them
    with without_garbage_collection():
        from app import server  # noqa: PLC0415 - its imports take most of a second
    # A link that is opened before the server answers looks broken.
    server.serve(settings, on_ready=partial(show_links, settings) if shows_links else None)
    _end_with_threads()
    return 0


@contextmanager
def _naming_options(options: Mapping[str, Any]) -> Iterator[None]:
    """Name the options of the command in errors about settings, in place of their variables."""
    try:
        yield
    except InvalidInput as error:
        message = str(error)
        for name, value in options.items():
            if value is not None:
                message = message.replace(f"{variable_of(name)} must", f"{flag(name)} must")
        raise InvalidInput(message) from error


def _end_with_threads() -> None:
    """End the process if threads compute on for requests that nobody can answer any more.

    Python would wait for them, and an agent of a user's own may compute for any time.
    """
    deadline_s = time.monotonic() + THREADS_END_S
    for thread in threading.enumerate():
        if not thread.daemon and thread is not threading.current_thread():
            thread.join(max(0.0, deadline_s - time.monotonic()))
            if thread.is_alive():
                sys.stdout.flush()
                sys.stderr.flush()
                os._exit(0)


def read_token() -> str | None:
    """Return the token of the environment; None without one."""
    return os.environ.get("HEXAPODS_TOKEN") or None


def show_links(settings: Settings, port: int) -> None:
    """Print the links of operators and of others, the latter also as a QR code.

    Of several addresses the likeliest has the code, and the others are listed. Where phones reach
    none, there is the reason instead of a code.
    """
    from app.api.reachable import url_of  # noqa: PLC0415 - as for `serve` above
    from app.api.spectators import qr_code, shared_addresses, why_none  # noqa: PLC0415 - as above

    addresses = shared_addresses(settings, port)
    local = url_of(settings.host if is_loopback(settings.host) else "127.0.0.1", port)
    address, *others = addresses or [local]
    print(f"Operator (may start and stop):  {address}?token={settings.token}")
    audiences = [of_feature.audience for of_feature in settings.features if of_feature.audience]
    for audience in audiences or ["Spectators (may watch)"]:
        print(f"{audience + ':':32}{address}")
    if addresses:
        qr_code(address).terminal(out=sys.stdout, compact=True)
    else:
        print(why_none(settings))
    if others:
        print(f"The code is for {addresses[address]}. If phones cannot open it, try:")
    for other in others:
        print(f"  {other}  ({addresses[other]})")
    sys.stdout.flush()
