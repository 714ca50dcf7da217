"""Plans playheads: at which time of its run the picture of a show will be."""

from hexapods.shows.playhead import Playhead
from hexapods.shows.show import Show

_PLANNED_S, _PLANNED_LIVE_S = 20.0, 3.0
"""Real time for which playheads are planned [s], also of runs that are still computed."""
_NEARLY_USED_UP_S = 1.0
"""Real time that is left of a playhead when the next one is planned [s]."""
_GROWTH_TOLD_S = 1.0
"""Time after which it is told that more is computed, while the picture is held [s]."""
_DRIFT_S = 0.1
"""Real time by which the picture may be off its playhead [s]."""


def is_outdated(playhead: Playhead, show: Show, now: float, *, is_held: bool) -> bool:
    """Whether a show needs another playhead: it is off, used up, or more is computed.

    Args:
        playhead: the present one.
        show: the show, advanced to now.
        now: time of the server's clock [s].
        is_held: whether the picture stands still: it is paused, or at its end.
    """
    off_s = abs(playhead.time_at(now) - show.time_s)
    is_off = off_s > _DRIFT_S * max(playhead.rate_at(now), 1.0)
    is_used_up = not is_held and playhead.rate > 0 and playhead.ends_s - now < _NEARLY_USED_UP_S
    # Of a picture that is held, only the time bar shows what is computed.
    has_grown = playhead.computed_s != _milliseconds(show.computed_s)
    has_grown &= not is_held or now - playhead.at_s >= _GROWTH_TOLD_S
    return is_off or is_used_up or has_grown


def planned(
    show: Show, now: float, speed: float | None, *, is_held: bool, is_computed: bool
) -> Playhead:
    """Return the playhead of a show from now on.

    Args:
        show: the show, advanced to now.
        now: time of the server's clock [s].
        speed: times real time; None for the show's automatic speed.
        is_held: whether the picture stands still.
        is_computed: whether the run is still computed, so that more will be known soon.
    """
    points = [(0.0, show.time_s)]
    rate = 0.0
    if not is_held:
        longest_s = _PLANNED_LIVE_S if is_computed else _PLANNED_S
        points = show.upcoming(speed, longest_s)
        if len(points) > 1 and points[-1][0] >= longest_s:
            (begin_s, before_s), (end_s, after_s) = points[-2:]
            rate = (after_s - before_s) / (end_s - begin_s)
    return Playhead(
        at_s=round(now, 4),
        points=[(round(after_s, 4), round(time_s, 4)) for after_s, time_s in points],
        rate=round(rate, 4),
        computed_s=_milliseconds(show.computed_s),
        duration_s=None if show.duration_s is None else _milliseconds(show.duration_s),
        time_out_s=None if show.time_out_s is None else _milliseconds(show.time_out_s),
    )


def _milliseconds(time_s: float) -> float:
    """Round a time [s] as pages have it in the figures of a moment."""
    return round(time_s, 3)
