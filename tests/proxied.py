"""A real nginx in front of a server, on a free port of this machine."""

import socket
import subprocess
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import pytest

from tests.install_proxy import HOW_TO_GET_NGINX, find_nginx

_STARTS_WITHIN_S = 30
_ENDS_WITHIN_S = 20
_CONFIG = """
daemon off;
master_process off;
pid {folder}/nginx.pid;
error_log {folder}/error.log;
events {{}}
http {{
    access_log {folder}/access.log combined buffer=1k flush=100ms;
    client_body_temp_path {folder}/body;
    proxy_temp_path {folder}/proxy;
    fastcgi_temp_path {folder}/fastcgi;
    uwsgi_temp_path {folder}/uwsgi;
    scgi_temp_path {folder}/scgi;
    client_max_body_size 64m;
    proxy_http_version 1.1;
    proxy_buffering off;
    proxy_set_header Host $http_host;
    proxy_set_header Connection "";
    proxy_set_header X-Forwarded-For $remote_addr;
    proxy_set_header X-Forwarded-Proto $scheme;
{servers}
}}
"""


class Location(NamedTuple):
    """A path of the proxy.

    Attributes:
        path: with slashes around it.
        to: the server's address, with a slash at its end.
        is_stripped: whether the server is asked for what follows the path.
        forwards_path: whether the header `X-Forwarded-Prefix` has the path.
    """

    path: str
    to: str
    is_stripped: bool = True
    forwards_path: bool = False

    @property
    def block(self) -> str:
        """Its part of nginx's configuration."""
        target = self.to if self.is_stripped else self.to.rstrip("/")
        # A location with headers of its own has none of those around it.
        prefix = f"proxy_set_header X-Forwarded-Prefix {self.path.rstrip('/')};"
        return f"""
        location {self.path} {{
            proxy_pass {target};
            proxy_set_header Host $http_host;
            proxy_set_header Connection "";
            proxy_set_header X-Forwarded-For $remote_addr;
            proxy_set_header X-Forwarded-Proto $scheme;
            {prefix if self.forwards_path else ""}
        }}"""


class Proxy:
    """An nginx with its log.

    Attributes:
        port: on which it listens.
    """

    def __init__(self, folder: Path, port: int) -> None:
        """Describe a proxy whose files are in a folder."""
        self.port, self._folder = port, folder

    def requested(self) -> list[str]:
        """Return the paths of all requests so far."""
        time.sleep(0.2)  # its log is written every tenth of a second
        lines = (self._folder / "access.log").read_text().splitlines()
        return [line.split('"')[1].split(" ")[1] for line in lines]


@contextmanager
def proxied(
    folder: Path,
    port: int,
    locations: Sequence[Location] = (),
    pages: Mapping[str, str] = MappingProxyType({}),
    *,
    has_tls: bool = False,
) -> Iterator[Proxy]:
    """Run an nginx for as long as the block lasts; what is at no location is answered with 418.

    Args:
        folder: of its files, which is made.
        port: on which it listens.
        locations: what it offers.
        pages: HTML of further pages by their paths.
        has_tls: whether it speaks HTTPS, by a certificate that it signs itself, or plain HTTP.
    """
    nginx = find_nginx()
    if nginx is None:
        pytest.fail(HOW_TO_GET_NGINX, pytrace=False)
    folder.mkdir()
    for name, html in pages.items():
        (folder / f"page-{name.strip('/')}.html").write_text(html)
    of_pages = [
        f"""
        location = {name} {{
            default_type text/html;
            alias {folder}/page-{name.strip("/")}.html;
        }}"""
        for name in pages
    ]
    server = f"""
    server {{
        listen 127.0.0.1:{port}{" ssl" if has_tls else ""};
        {_certificate(folder) if has_tls else ""}
        {"".join([*(location.block for location in locations), *of_pages])}
        location / {{ return 418; }}
    }}"""
    config = folder / "nginx.conf"
    config.write_text(_CONFIG.format(folder=folder, servers=server))
    command = [str(nginx), "-p", str(folder), "-c", str(config), "-e", str(folder / "start.log")]
    process = subprocess.Popen(command)
    try:
        _wait_until_open(port, process, folder)
        yield Proxy(folder, port)
    finally:
        process.terminate()
        process.wait(_ENDS_WITHIN_S)


def _certificate(folder: Path) -> str:
    """Make a certificate with its key; return nginx's directives for both."""
    certificate, key = folder / "certificate.pem", folder / "key.pem"
    files = ["-out", str(certificate), "-keyout", str(key)]
    kind = ["-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes"]
    subject = ["-subj", "/CN=localhost", "-days", "2"]
    command = ["openssl", "req", "-x509", *kind, *subject, *files]
    subprocess.run(command, check=True, capture_output=True)
    return f"ssl_certificate {certificate}; ssl_certificate_key {key};"


def _wait_until_open(port: int, process: "subprocess.Popen[bytes]", folder: Path) -> None:
    deadline_s = time.monotonic() + _STARTS_WITHIN_S
    while True:
        said = [log.read_text() for log in folder.glob("*.log")]
        assert process.poll() is None, f"nginx ended: {said}"
        assert time.monotonic() < deadline_s, f"nginx does not answer: {said}"
        with suppress(OSError), socket.create_connection(("127.0.0.1", port), 1):
            return
        time.sleep(0.05)


def free_port() -> int:
    """Return a port of this machine that is free."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port: int = free.getsockname()[1]
    return port
