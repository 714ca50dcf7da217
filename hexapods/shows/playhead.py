"""Playhead: at which time of its run a picture is at a time of the server's clock."""

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from operator import itemgetter

from hexapods.domain.records import Record

Point = tuple[float, float]
"""Time after the beginning of a playhead [s], and time of the run at which the picture is then."""
_TOLERANCE_S = 1 / 60
"""Largest error of a simplified playhead, as a time of the clock [s]."""


@dataclass(frozen=True, kw_only=True)
class Playhead(Record):
    """The time of the run that is shown [s], as a function of the time of the server's clock.

    Attributes:
        at_s: time of the clock at the first point [s].
        points: at `at_s + after_s` the picture is at `time_s` of the run; between two points it
            moves uniformly. At least one, in order of time.
        rate: seconds of the run per second after the last point; 0 where it holds there.
        computed_s: time of the run up to which it is computed.
        duration_s: of the run; null while it is not known.
        time_out_s: of a race; null of a training, and until it is known.
    """

    at_s: float
    points: list[Point]
    rate: float
    computed_s: float
    duration_s: float | None
    time_out_s: float | None

    @property
    def ends_s(self) -> float:
        """Time of the clock at the last point [s]."""
        return self.at_s + self.points[-1][0]

    def time_at(self, now_s: float) -> float:
        """Return the time of the run at a time of the clock [s]."""
        after_s = now_s - self.at_s
        index = bisect_right(self.points, after_s, key=itemgetter(0))
        if index == 0:
            return self.points[0][1]
        begin_s, time_s = self.points[index - 1]
        return time_s + self._rate_after(index - 1) * (after_s - begin_s)

    def rate_at(self, now_s: float) -> float:
        """Return the seconds of the run per second at a time of the clock [s]."""
        index = bisect_right(self.points, now_s - self.at_s, key=itemgetter(0))
        return self._rate_after(max(0, index - 1))

    def when(self, time_s: float, since_s: float) -> float:
        """Return the first time of the clock, from one on, at which the run is at a time or later.

        Infinity if it never is.
        """
        if self.time_at(since_s) >= time_s:
            return since_s
        for (begin_s, before_s), (end_s, after_s) in zip(
            self.points, self.points[1:], strict=False
        ):
            if self.at_s + end_s > since_s and before_s < time_s <= after_s:
                share = (time_s - before_s) / (after_s - before_s)
                return max(since_s, self.at_s + begin_s + share * (end_s - begin_s))
        end_s, last_s = self.points[-1]
        if self.rate <= 0 or last_s > time_s:
            return math.inf
        return max(since_s, self.at_s + end_s + (time_s - last_s) / self.rate)

    def _rate_after(self, index: int) -> float:
        if index == len(self.points) - 1:
            return self.rate
        (begin_s, before_s), (end_s, after_s) = self.points[index : index + 2]
        return (after_s - before_s) / (end_s - begin_s) if end_s > begin_s else 0.0


def simplified(points: Sequence[Point]) -> list[Point]:
    """Return some of the points, from the first to the last, between which the others lie.

    No other one is off by more than the run's time in 1/60 s, at the rate around it.

    Args:
        points: in order of time, at least one.
    """
    kept, last = [points[0]], len(points) - 1
    start = 0
    while start < last:
        low, high = -math.inf, math.inf
        end = start + 1
        for index in range(start + 1, last + 1):
            elapsed_s = points[index][0] - points[start][0]
            moved_s = points[index][1] - points[start][1]
            pace = moved_s / elapsed_s
            if not low <= pace <= high:
                break
            end = index
            step_s = points[index][0] - points[index - 1][0]
            rate = abs(points[index][1] - points[index - 1][1]) / step_s
            margin = _TOLERANCE_S * rate / elapsed_s
            low, high = max(low, pace - margin), min(high, pace + margin)
        kept.append(points[end])
        start = end
    return kept
