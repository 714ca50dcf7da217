"""Disk space of the data folder: quota, minimum free space, and a reserve file.

The reserve file is deleted when the disk is full, which lets the database commit once more.
"""

import os
import shutil
import threading
from contextlib import suppress
from pathlib import Path

from app.storage.errors import StorageFailed, StorageFull

MB = 1_000_000
START_BYTES = 5 * MB
"""Space required to start a run: the size of a typical run's files."""
MIN_FREE_BYTES = 1 * MB
"""Free space that artifacts must leave on the disk for the database."""
RESERVE_BYTES = 1 * MB
"""Size of the reserve file, which is deleted when the disk is full."""
RESERVE_FILE = "reserve"


class DiskSpace:
    """Checks the quota and the free disk space of a folder. Thread-safe."""

    def __init__(self, folder: Path, quota_mb: int | None = None) -> None:
        """Use an existing folder.

        Args:
            folder: the data folder.
            quota_mb: maximum total size of its files [MB]; None for no quota.
        """
        self._folder, self._quota_mb = folder, quota_mb
        self._reserve, self._lock = folder / RESERVE_FILE, threading.Lock()
        self._keeps_reserve = False

    def check(self, size: int) -> None:
        """Check that a new file fits into the quota and onto the disk.

        Args:
            size: of the file [bytes].

        Raises:
            StorageFull: if it does not fit.
        """
        if self._quota_mb is not None and self.used_bytes() + size > self._quota_mb * MB:
            raise StorageFull(
                f"the data folder may take {self._quota_mb:,} MB, and {_mb(size)} more would be "
                "over that; delete runs, or raise HEXAPODS_QUOTA_MB"
            )
        free = shutil.disk_usage(self._folder).free
        if free < size + MIN_FREE_BYTES:
            raise StorageFull(
                f"the disk of the data folder has {_mb(free)} left, too little for {_mb(size)} "
                "more; delete runs, or make room there"
            )
        if self._keeps_reserve:
            self.reserve()

    def used_bytes(self) -> int:
        """Return the total size of the files in the folder [bytes]."""
        total = 0
        for base, _, names in os.walk(self._folder):
            for name in names:
                # Files may be deleted during the walk.
                with suppress(FileNotFoundError):
                    total += (Path(base) / name).stat().st_size
        return total

    def reserve(self) -> None:
        """Create the reserve file if there is space, and recreate it later after each release."""
        with self._lock:
            self._keeps_reserve = True
            if self._reserve.exists():
                return
            try:
                if shutil.disk_usage(self._folder).free > RESERVE_BYTES + MIN_FREE_BYTES:
                    self._reserve.touch(mode=0o600)
                    # Written zeros: a sparse file would not allocate any disk blocks.
                    self._reserve.write_bytes(bytes(RESERVE_BYTES))
            except OSError:
                self._reserve.unlink(missing_ok=True)

    def release(self) -> bool:
        """Delete the reserve file to free its space; return whether there was one.

        Raises:
            StorageFailed: if it cannot be deleted.
        """
        with self._lock:
            try:
                self._reserve.unlink()
            except FileNotFoundError:
                return False
            except OSError as error:
                raise StorageFailed(f"the data folder cannot be changed ({error.strerror})") from (
                    error
                )
            return True


def _mb(size: int) -> str:
    return f"{size / MB:,.1f} MB"
