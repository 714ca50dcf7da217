"""A replay as one page that needs no server: viser's client, a player and the frames of the run.

The page is `viser_internals.client`'s with `static/js/offline/player.js` and the modules that this
imports (`offline_page`), and blocks of data: `replay`, JSON about the run; `scene` and `segment-…`,
the encodings of `drawing.replay_encoding`.
"""

from collections.abc import Callable, Iterator

from hexapods.domain.errors import TooLong
from hexapods.domain.records import to_json, to_json_bytes
from hexapods.drawing.viser_internals.client import OFFLINE_SCRIPTS, content_policy, patched_page
from hexapods.offline_page import data_block, digest, import_map, styles
from hexapods.runs.clocks import CLOCK_TITLES
from hexapods.runs.recording import FIRST_STEPS, NEWEST_STEPS
from hexapods.shows.replay import HIGHEST_LEVEL, ReplayView

MAX_BYTES = 15_000_000
"""Maximum size of a page; a longer run has fewer frames in a second."""
MAX_SEGMENTS = 1000
"""Maximum number of segments, 35 minutes at 30 frames a second: a robot that stands still is small,
and takes as long to encode as one that walks."""
Segment = Callable[[int, int], bytes]
_SAMPLED = 8
"""Number of segments from whose size it is decided that a level is far too large."""
_PLAYER = "js/offline/player.js"
_STYLE = "style/offline.css"
_BODY_END = "</body>"


def replay_page(
    plan: ReplayView,
    scene: Callable[[], bytes],
    segment: Segment,
    title: str,
    max_bytes: int = MAX_BYTES,
) -> Iterator[bytes]:
    """Yield the page of a run that has ended, in chunks of at most a segment.

    Args:
        plan: plan of the replay.
        scene: returns the encoding of the scene at the start of the run.
        segment: returns the encoding of a segment, by its level and number.
        title: title of the page.
        max_bytes: maximum size of the page.

    Raises:
        TooLong: at the call.
    """
    plan_json, start = to_json_bytes(plan), data_block("scene", scene())
    before, after = _around_frames(title, plan_json.decode() + start)
    room = max_bytes - len(before) - len(after) - len(start) - len(plan_json) - 2000
    level, numbers = _segments_that_fit(segment, plan, room)
    replay = {**to_json(plan), "title": title, "level": level, "notes": _notes(plan, level)}

    def chunks() -> Iterator[bytes]:
        yield before
        yield f"{data_block('replay', replay)}\n{start}\n".encode()
        for number in numbers:
            yield f"{data_block(f'segment-{number}', segment(level, number))}\n".encode()
        yield after

    return chunks()


def _segments_that_fit(segment: Segment, plan: ReplayView, room: int) -> tuple[int, list[int]]:
    """Return the lowest level from 0 on whose segments fit into `room` bytes, and their numbers."""

    def size_of(level: int, number: int) -> int:
        encoded = 4 * -(-len(segment(level, number)) // 3)
        return len(data_block(f"segment-{number}", b"")) + len("\n") + encoded

    for level in range(HIGHEST_LEVEL + 1):
        numbers, size = _recorded_segments(plan, level), 0
        if len(numbers) > MAX_SEGMENTS:
            continue
        # If a level is far too large, encode a few of its segments only.
        few = numbers[:: max(1, len(numbers) // _SAMPLED)]
        size = sum(size_of(level, number) for number in few)  # whole numbers
        if size * len(numbers) > 2 * room * len(few):
            continue
        for number in numbers:
            size += size_of(level, number)
            if size > room:
                break
        else:
            return level, numbers
    raise TooLong(
        f"the {plan.kind} is too long for a page of {MAX_BYTES // 1_000_000} MB; replay it on "
        "the server"
    )


def _recorded_segments(plan: ReplayView, level: int) -> list[int]:
    """Return the numbers of the segments that have recorded frames, `MAX_SEGMENTS` + 1 at most."""
    segment_s = plan.frame_s * plan.segment_frames * 2**level
    numbers: list[int] = []
    for from_s, to_s in plan.recorded_s:
        first = max(int(from_s / segment_s), numbers[-1] + 1 if numbers else 0)
        last = int(to_s / segment_s)
        numbers += range(first, min(last, first + MAX_SEGMENTS - len(numbers)) + 1)
    return [number for number in numbers if number * segment_s <= plan.recorded_s[-1][1]]


def _notes(plan: ReplayView, level: int) -> list[str]:
    """Return sentences on the clock, and on the frames and steps that the page leaves out."""
    notes = []
    if level > 0:
        rate = 1 / (plan.frame_s * 2**level)
        notes.append(f"{rate:.3g} pictures a second of the run's time, so that the file is small.")
    if len(plan.recorded_s) > 1:
        notes.append(
            f"Only the first {FIRST_STEPS} and the newest {NEWEST_STEPS} steps of this practice "
            "are recorded."
        )
    return [*notes, f"Times: {CLOCK_TITLES[plan.clock or 'free']}."]


def _around_frames(title: str, content: str) -> tuple[bytes, bytes]:
    """Return the page before and after the blocks of data.

    Args:
        title: title of the page.
        content: what else differs between pages; the nonce depends on it.
    """
    modules = import_map(_PLAYER)
    nonce = digest(modules + title + content)
    head = (
        f'<style>{styles(_STYLE)}</style><script type="importmap">{modules}</script>'
        f'<script type="module" nonce="{nonce}">import "{_PLAYER}";</script>'
    )
    page = patched_page(title, OFFLINE_SCRIPTS, head)
    policy = content_policy(page, file_nonce=nonce)
    meta = f'<meta http-equiv="Content-Security-Policy" content="{policy}">'
    page = page.replace("<head>", f'<head><meta charset="utf-8">{meta}', 1)
    before, after = page.rsplit(_BODY_END, 1)
    return before.encode(), (_BODY_END + after).encode()
