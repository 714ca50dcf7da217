"""Promise 3, for the store: a full disk fails the run, and nothing else.

Promised: on a file system of 16 MB the run is `failed` in at most 5 s with a clear error, reads
are still served, and all works again once there is room. The file system is a tmpfs, mounted in a
mount namespace where that is allowed; RLIMIT_FSIZE, which works everywhere, is tested as well.
The limit of 5 s applies under `make soak`.
"""

import json
import subprocess
from pathlib import Path

import pytest

from tests.promises.length import at_length
from tests.promises.processes import start_script
from tests.timeouts import LONG_S


def mount_namespace() -> tuple[str, ...] | None:
    """Return the `unshare` command that gives a process its own mounts; None if not permitted."""
    for unshare in (("unshare", "--mount"), ("unshare", "--map-root-user", "--mount")):
        mount = [*unshare, "mount", "-t", "tmpfs", "tmpfs", "/mnt"]
        try:
            if subprocess.run(mount, capture_output=True, check=False).returncode == 0:
                return unshare
        except FileNotFoundError:
            return None
    return None


FAILED_S = at_length(LONG_S, 5.0)
UNSHARE = mount_namespace()
WAYS = ["limit"] if UNSHARE is None else ["limit", "mount"]
_MOUNT = 'mount -t tmpfs -o size=16m tmpfs "$0" && exec "$@"'


@pytest.mark.parametrize("how", WAYS)
def test_a_full_disk_fails_the_run_and_nothing_else(how: str, tmp_path: Path) -> None:
    before = (*(UNSHARE or ()), "sh", "-c", _MOUNT, str(tmp_path)) if how == "mount" else ()
    process = start_script("tests.promises.full_disk", str(tmp_path), how, before=before)
    out, _ = process.communicate()
    assert process.returncode == 0
    report = json.loads(out)

    for message in report["messages"]:
        assert "disk of the data folder" in message
        assert "delete runs, or make room" in message
    assert report["failed_after_s"] <= FAILED_S
    assert (report["state"], report["listed"]) == ("failed", 2)
    assert report["updated"] == 49
    assert report["reserve_is_left"] == (how == "limit")
    assert report["old_file_is_whole"]
    assert report["works_again"]
    assert report["states"] == {"a": "failed", "b": "interrupted", "c": "interrupted"}
    assert report["files"] == 2
