"""Audit hook that logs every connection and started program of a Python process.

Python imports `sitecustomize` at its start in every process with this folder in PYTHONPATH. The log
file is given by `AUDIT_FILE`, without the prefix `HEXAPODS_` of the app's settings.
"""

import os
import sys
from typing import Any

_WATCHED = frozenset(
    {
        "socket.connect",
        "socket.sendto",
        "socket.sendmsg",
        "socket.getaddrinfo",
        "socket.gethostbyname",
        "socket.bind",
        "subprocess.Popen",
        "os.system",
        "os.exec",
        "os.posix_spawn",
        "webbrowser.open",
    }
)
_file = os.open(os.environ["AUDIT_FILE"], os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o600)


def _audit_hook(event: str, arguments: tuple[Any, ...]) -> None:
    if event in _WATCHED:
        details = arguments[1:] if event.startswith("socket.") and len(arguments) > 1 else arguments
        if event.startswith("socket.get"):
            details = arguments
        os.write(_file, f"{event} {details!r}\n".encode("utf-8", "replace"))


sys.addaudithook(_audit_hook)
