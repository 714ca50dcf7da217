"""A clock that tests set."""

from datetime import UTC, datetime, timedelta


class Clock:
    """Both clocks of a demo: that of the day, and the monotonic one; neither moves by itself.

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
        """Let time pass."""
        self.now += timedelta(**parts)
