"""What can go wrong with runs, beside bad input."""

from app.domain.errors import HexapodError


class NotFound(HexapodError):
    """There is no such thing (any more)."""


class Conflict(HexapodError):
    """It cannot be done in the run's present state, which is `state`."""

    def __init__(self, message: str, state: str) -> None:
        super().__init__(message)
        self.state = state


class Damaged(Conflict):
    """A stored run cannot be read; the message says why, and how to be rid of it."""

    def __init__(self, run_id: str, why: str) -> None:
        super().__init__(
            f"run {run_id} is damaged: {why}; delete it, or restore a backup", "damaged"
        )


class Gone(HexapodError):
    """It was here once, and was deleted."""


class Busy(HexapodError):
    """Too much is waiting; worth another try after `retry_after_s`."""

    def __init__(self, message: str, retry_after_s: int) -> None:
        super().__init__(message)
        self.retry_after_s = retry_after_s


class JobFailed(HexapodError):
    """A job's process ended without a result; the message says how."""


class StorageFull(HexapodError):
    """There is no room for what is to be kept; whatever was kept before is as it was."""


class StorageFailed(HexapodError):
    """The store cannot be used at the moment; the message says why."""


class OwnershipLost(StorageFailed):
    """Another server has taken the database over; this one must write nothing more."""


class NotAnswering(HexapodError):
    """A job's process does not answer; nothing was changed."""

    def __init__(self, message: str, retry_after_s: int) -> None:
        super().__init__(message)
        self.retry_after_s = retry_after_s
