"""Exceptions of the run store and of job control, other than invalid input."""

from hexapods.domain.errors import HexapodError


class NotFound(HexapodError):
    """The requested run or file does not exist, or no longer exists."""


class Conflict(HexapodError):
    """The operation is not allowed in the run's present state, which is `state`."""

    def __init__(self, message: str, state: str) -> None:
        super().__init__(message)
        self.state = state


class Forbidden(HexapodError):
    """The client may not do this; HTTP 403."""


class Damaged(Conflict):
    """A stored run cannot be decoded; the message says why, and what to do about it."""

    def __init__(self, run_id: str, why: str) -> None:
        super().__init__(
            f"run {run_id} is damaged: {why}; delete it, or restore a backup", "damaged"
        )


class Gone(HexapodError):
    """The run existed and was deleted."""


class Busy(HexapodError):
    """The server is at capacity; retry after `retry_after_s` seconds."""

    def __init__(self, message: str, retry_after_s: int) -> None:
        super().__init__(message)
        self.retry_after_s = retry_after_s


class StorageFull(HexapodError):
    """The disk or the quota is full; what was stored before is unchanged."""


class StorageFailed(HexapodError):
    """The store is unavailable; the message says why."""


class OwnershipLost(StorageFailed):
    """The fencing token is out of date: another server owns the database now.

    This process must not write any more.
    """


class NotAnswering(HexapodError):
    """A job's process did not respond in time; nothing was changed."""

    def __init__(self, message: str, retry_after_s: int) -> None:
        super().__init__(message)
        self.retry_after_s = retry_after_s
