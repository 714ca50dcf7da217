"""Room in the data folder: a quota, a share that stays free, and a reserve for the database."""

import os
import shutil
import threading
from contextlib import suppress
from pathlib import Path

from app.storage.errors import StorageFailed, StorageFull

MB = 1_000_000
START_BYTES = 5 * MB
"""Room that has to be there for a run to start: what a usual one leaves behind."""
KEPT_FREE_BYTES = 1 * MB
"""Arrays leave so much of the disk to the database."""
RESERVE_BYTES = 1 * MB
"""Given up when the disk is full, so that the database can still note what came of that."""
_RESERVE = "reserve"


class DiskSpace:
    """The room that is left in a folder. Safe to use from any thread."""

    def __init__(self, folder: Path, quota_mb: int | None = None) -> None:
        """Look after a folder that exists.

        Args:
            folder: the data folder.
            quota_mb: how much all in it may take, in MB; None for as much as the disk has.
        """
        self._folder, self._quota_mb = folder, quota_mb
        self._reserve, self._lock = folder / _RESERVE, threading.Lock()
        self._keeps_reserve = False

    def check(self, size: int) -> None:
        """Make sure that there is room for a new file.

        Args:
            size: of the file, in bytes.

        Raises:
            StorageFull: if there is not.
        """
        if self._quota_mb is not None and self.used_bytes() + size > self._quota_mb * MB:
            raise StorageFull(
                f"the data folder may take {self._quota_mb:,} MB, and {_mb(size)} more would be "
                "over that; delete runs, or raise HEXAPODS_QUOTA_MB"
            )
        free = shutil.disk_usage(self._folder).free
        if free < size + KEPT_FREE_BYTES:
            raise StorageFull(
                f"the disk of the data folder has {_mb(free)} left, too little for {_mb(size)} "
                "more; delete runs, or make room there"
            )
        if self._keeps_reserve:
            self.reserve()

    def used_bytes(self) -> int:
        """What all in the folder takes."""
        total = 0
        for base, _, names in os.walk(self._folder):
            for name in names:
                # Files come and go meanwhile.
                with suppress(FileNotFoundError):
                    total += (Path(base) / name).stat().st_size
        return total

    def reserve(self) -> None:
        """Set the reserve aside as soon as there is room for it, and again after each release."""
        with self._lock:
            self._keeps_reserve = True
            if self._reserve.exists():
                return
            try:
                if shutil.disk_usage(self._folder).free > RESERVE_BYTES + KEPT_FREE_BYTES:
                    # Real zeros: a file with a hole would reserve nothing.
                    self._reserve.write_bytes(bytes(RESERVE_BYTES))
            except OSError:
                self._reserve.unlink(missing_ok=True)

    def release(self) -> bool:
        """Give the reserve up. True if there was one."""
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
