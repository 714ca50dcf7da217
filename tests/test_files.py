"""Atomic writes and file locks."""

import subprocess
import sys
from pathlib import Path

import pytest

from hexapods.files import lock_file, write_atomically


def test_failed_write_keeps_the_old_file_and_leaves_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "file"
    write_atomically(path, b"old")

    def fail(_handle: int) -> None:
        raise OSError("the disk is gone")

    with monkeypatch.context() as patch:
        patch.setattr("hexapods.files.os.fsync", fail)
        with pytest.raises(OSError, match="gone"):
            write_atomically(path, b"new")
    assert [entry.name for entry in tmp_path.iterdir()] == ["file"]
    assert path.read_bytes() == b"old"
    write_atomically(path, b"new")
    assert path.read_bytes() == b"new"


def test_lock_excludes_other_processes_until_the_file_is_closed(tmp_path: Path) -> None:
    path = tmp_path / "lock"
    script = (
        "import sys; from hexapods.files import lock_file\n"
        f"try: lock_file(open({str(path)!r}, 'ab'))\nexcept OSError: sys.exit(3)"
    )

    def other_process() -> int:
        return subprocess.run([sys.executable, "-c", script], check=False).returncode

    with path.open("ab") as file:
        lock_file(file)
        assert other_process() == 3
    assert other_process() == 0
