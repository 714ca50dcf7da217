"""Find nginx for the tests, or unpack Debian's: `.venv/bin/python tests/install_proxy.py`.

It is unpacked below `build/` and not installed, which would start a server on port 80. All that it
needs beside are libraries that every Debian with Python has.
"""

import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

HOW_TO_GET_NGINX = (
    "The tests of a server behind a proxy need nginx, and none was found. Install it (on Debian: "
    "apt-get install nginx), or unpack Debian's by '.venv/bin/python tests/install_proxy.py'."
)
_UNPACKED = Path(__file__).parent.parent / "build" / "nginx"
_DOWNLOAD = ["apt-get", "download", "--quiet", "nginx"]


def find_nginx() -> Path | None:
    """Return the installed nginx, or that which was unpacked here; None if neither starts."""
    path = f"{os.environ.get('PATH', '')}:/usr/sbin:/usr/local/sbin"
    candidates = [shutil.which("nginx", path=path), str(_UNPACKED / "usr" / "sbin" / "nginx")]
    return next((Path(c) for c in candidates if c and _succeeds([c, "-v"])), None)


def main() -> int:
    """Print the path of nginx, after unpacking it where there is none."""
    nginx = find_nginx()
    if nginx is None and shutil.which("apt-get") is not None:
        _unpack()
        nginx = find_nginx()
    if nginx is None:
        print(HOW_TO_GET_NGINX, file=sys.stderr)
        return 1
    print(f"Proxy for the tests: {nginx}")
    return 0


def _unpack() -> None:
    _UNPACKED.mkdir(parents=True, exist_ok=True)
    if not _succeeds(_DOWNLOAD, _UNPACKED):
        # The lists of packages may be missing or old. To update them needs root, or sudo.
        as_root = [] if os.geteuid() == 0 else ["sudo", "--non-interactive"]
        _succeeds([*as_root, "apt-get", "update", "--quiet"])
        print("$", *_DOWNLOAD, flush=True)
        subprocess.run(_DOWNLOAD, cwd=_UNPACKED, check=False)
    for package in _UNPACKED.glob("nginx_*.deb"):
        subprocess.run(["dpkg-deb", "--extract", package, _UNPACKED], check=False)


def _succeeds(command: Sequence[str], folder: Path | None = None) -> bool:
    try:
        done = subprocess.run(command, cwd=folder, capture_output=True, timeout=120, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return False
    return done.returncode == 0


if __name__ == "__main__":
    sys.exit(main())
