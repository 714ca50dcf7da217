"""A clock that tests set."""

from datetime import UTC, datetime, timedelta


class Clock:
    """Both clocks of a demo, the time of day and the monotonic one, which a test sets.

    Attributes:
        now: in UTC.
    """

    def __init__(self) -> None:
        """Begin at the time of the machine, which runs are stored with."""
        self.now = datetime.now(UTC)
        self._since = self.now

    def time(self) -> datetime:
        """Return the time of the day."""
        return self.now

    def seconds(self) -> float:
        """Return the monotonic time [s]."""
        return (self.now - self._since).total_seconds()

    def pass_time(self, **parts: float) -> None:
        """Advance both clocks."""
        self.now += timedelta(**parts)
