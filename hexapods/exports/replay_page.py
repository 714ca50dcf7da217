"""A replay as one page that needs no server: viser's client, a player and the frames of the run.

The page has `static/js/offline/player.js` and the modules that this imports (`offline_page`), a
picture for where no script may run, and blocks of data: `replay`, JSON about the run; `viewer`, the
page of `viser_internals.client`, which it has in a frame; `scene` and `segment-CLOCK-…`, the
encodings of `drawing.replay_encoding`.
"""

import base64
from collections.abc import Iterator, Sequence
from html import escape

from hexapods.domain.errors import TooLong
from hexapods.domain.records import to_json, to_json_bytes
from hexapods.drawing.viser_internals.client import OFFLINE_SCRIPTS, content_policy, patched_page
from hexapods.exports.export_format import EncodedReplay, StagePicture
from hexapods.offline_page import data_block, digest, import_map, styles
from hexapods.runs.clocks import CLOCK_TITLES
from hexapods.runs.recording import FIRST_STEPS, NEWEST_STEPS
from hexapods.shows.replay import HIGHEST_LEVEL, ReplayView

MAX_BYTES = 15_000_000
"""Maximum size of a page; a longer run has fewer frames in a second."""
MAX_SEGMENTS = 1000
"""Maximum number of segments, 35 minutes at 30 frames a second: a robot that stands still is small,
and takes as long to encode as one that walks."""
_SAMPLED = 8
"""Number of segments from whose size it is decided that a level is far too large."""
_PLAYER = "js/offline/player.js"
_STYLES = ("viewer/patch.css", "style/offline.css")
"""The first for what is behind the picture of the view."""
_WITHOUT_SCRIPTS = (
    "A picture of the end of the run: it plays where scripts may run, as from a file in a browser."
)


def replay_page(
    replays: Sequence[EncodedReplay], title: str, max_bytes: int = MAX_BYTES
) -> Iterator[bytes]:
    """Yield the page of a run that has ended, in chunks of at most a segment.

    Args:
        replays: of the run, as timed by one clock each; the page begins with the first, and has of
            the others those that fit, too.
        title: title of the page.
        max_bytes: maximum size of the page.

    Raises:
        TooLong: at the call.
    """
    first, *others = replays
    plan, picture = first.plan, first.picture()
    plan_json, start = to_json_bytes(plan), data_block("scene", first.scene())
    before, after = _around_frames(title, picture, plan_json.decode() + start)
    room = max_bytes - len(before) - len(after) - len(start) - len(plan_json) - 2000
    level, numbers, size = _segments_that_fit(first, room)
    fitting = [(first, numbers)]
    for other in others:
        room -= size + len(to_json_bytes(other.plan))
        try:
            _, numbers, size = _segments_that_fit(other, room, level, level)
        except TooLong:
            break
        fitting.append((other, numbers))
    replay = {
        "title": title,
        "level": level,
        "notes": _notes(plan, level),
        "clocks": CLOCK_TITLES,
        "plans": [to_json(encoded.plan) for encoded, _ in fitting],
    }

    def chunks() -> Iterator[bytes]:
        yield before
        yield f"{data_block('replay', replay)}\n{start}\n".encode()
        for encoded, numbers in fitting:
            for number in numbers:
                block = data_block(_name(encoded.plan, number), encoded.segment(level, number))
                yield f"{block}\n".encode()
        yield after

    return chunks()


def _name(plan: ReplayView, number: int) -> str:
    """Return the id of a segment's block."""
    return f"segment-{plan.clock or 'free'}-{number}"


def _segments_that_fit(
    replay: EncodedReplay, room: int, lowest: int = 0, highest: int = HIGHEST_LEVEL
) -> tuple[int, list[int], int]:
    """Return the lowest level whose segments fit into `room` bytes, their numbers and their size.

    Raises:
        TooLong: if there is none from `lowest` to `highest`.
    """
    plan = replay.plan

    def size_of(level: int, number: int) -> int:
        encoded = 4 * -(-len(replay.segment(level, number)) // 3)
        return len(data_block(_name(plan, number), b"")) + len("\n") + encoded

    for level in range(lowest, highest + 1):
        numbers, size = _recorded_segments(plan, level), 0
        if len(numbers) > MAX_SEGMENTS:
            continue
        # If a level is far too large, encode a few of its segments only.
        few = numbers[:: max(1, len(numbers) // _SAMPLED)]
        sampled = sum(size_of(level, number) for number in few)  # whole numbers
        if sampled * len(numbers) > 2 * room * len(few):
            continue
        for number in numbers:
            size += size_of(level, number)
            if size > room:
                break
        else:
            return level, numbers, size
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
    """Return sentences on the frames and steps that the page leaves out."""
    notes = []
    if level > 0:
        rate = 1 / (plan.frame_s * 2**level)
        notes.append(f"{rate:.3g} pictures a second of the run's time, so that the file is small.")
    if len(plan.recorded_s) > 1:
        notes.append(
            f"Only the first {FIRST_STEPS} and the newest {NEWEST_STEPS} steps of this practice "
            "are recorded."
        )
    return notes


def _around_frames(title: str, picture: StagePicture, content: str) -> tuple[bytes, bytes]:
    """Return the page before and after the blocks of data.

    Args:
        title: title of the page.
        picture: what is seen before the page draws, and where it may not.
        content: what else differs between pages; the nonce depends on it.
    """
    modules, viewer = import_map(_PLAYER), patched_page(title, OFFLINE_SCRIPTS)
    nonce = digest(modules + title + content)
    policy = content_policy(viewer, file_nonce=nonce)
    png = base64.b64encode(picture.png).decode()
    before = (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8">'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">'
        f'<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{escape(title)}</title><style>{styles(*_STYLES)}</style>"
        f'<script type="importmap" nonce="{nonce}">{modules}</script>'
        f'<script type="module" nonce="{nonce}">import "{_PLAYER}";</script></head><body>'
        f'<figure class="poster"><img src="data:image/png;base64,{png}" '
        f'alt="{escape(picture.description)}"><figcaption>{_WITHOUT_SCRIPTS}</figcaption></figure>\n'
        f"{data_block('viewer', {'page': viewer})}\n"
    )
    return before.encode(), b"</body></html>\n"
