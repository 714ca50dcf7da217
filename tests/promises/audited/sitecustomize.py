"""Writes down what every Python process with this folder in its path connects to, and starts.

Python imports this by its name at its start. `HEXAPODS_AUDIT`-less names keep it out of the app's
settings: the file to write to is named by `AUDIT_FILE`.
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


def _watch(event: str, arguments: tuple[Any, ...]) -> None:
    if event in _WATCHED:
        said = arguments[1:] if event.startswith("socket.") and len(arguments) > 1 else arguments
        if event.startswith("socket.get"):
            said = arguments
        os.write(_file, f"{event} {said!r}\n".encode("utf-8", "replace"))


sys.addaudithook(_watch)
