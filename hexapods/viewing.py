"""View a race in 3D, in a browser or a notebook, by a page that needs no server."""

import base64
import html
import importlib.metadata
import os
import urllib.parse
import webbrowser
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import platformdirs

from hexapods.domain.errors import InvalidInput
from hexapods.exports.export_format import EncodedReplay, StagePicture
from hexapods.files import path_of, write_atomically
from hexapods.races import Race, race
from hexapods.runs.clocks import Clock, check_clock
from hexapods.shows.race_show import RaceShow
from hexapods.shows.replay import Replay
from hexapods.shows.scene_spec import race_scene
from hexapods.shows.show import RunLabel
from hexapods.trainings import Training

_HEIGHT_PX = 480


@dataclass(repr=False)
class View:
    """A page that plays a race, as `view` returns it; a notebook shows it by itself.

    Where a notebook lets no scripts run, it shows the picture and a sentence on how to play it.

    Attributes:
        title: of the page.
        page: the page, HTML.
        picture: of the time-out, PNG.
        description: of the picture, in words.
        file: where `save` wrote it last; the sentence under the picture links to it.
    """

    title: str
    page: str
    picture: bytes
    description: str
    file: Path | None = None

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the page to a file, to which what a notebook shows then links.

        Returns:
            the path.

        Raises:
            InvalidInput: if it is no path.
            OSError: if the file cannot be written.
        """
        target = path_of(path, "a file")
        write_atomically(target, self.page.encode())
        self.file = target
        return target

    def open(self) -> Path:
        """Open the page in a browser, from a file that the next one replaces.

        Returns:
            the path of the file, in the folder for caches of this user.

        Raises:
            OSError: if the file cannot be written.
        """
        # The browser may load the file again after this process has ended.
        folder = platformdirs.user_cache_path("racing-hexapods", False, ensure_exists=True)
        path = self.save(folder / "view.html")
        webbrowser.open(path.as_uri())
        return path

    def __repr__(self) -> str:
        return f"<View of {self.title}: {len(self.page) / 1e6:.1f} MB; save(path) or open()>"

    def _repr_html_(self) -> str:
        # The frame covers the picture, unless it is removed or the page in it may run no scripts.
        picture = f"data:image/png;base64,{base64.b64encode(self.picture).decode()}"
        title, page = html.escape(self.title), html.escape(self.page)
        return (
            f'<figure style="position:relative; margin:0; min-height:{_HEIGHT_PX}px">'
            f'<img src="{picture}" alt="{html.escape(self.description)}" style="max-width:100%">'
            f"<figcaption>{self._how_to_play()}</figcaption>"
            f'<iframe srcdoc="{page}" title="{title}" sandbox="allow-scripts" width="100%" '
            f'height="{_HEIGHT_PX}" style="position:absolute; inset:0; border:0"></iframe></figure>'
        )

    def _repr_png_(self) -> bytes:
        return self.picture

    def _how_to_play(self) -> str:
        """Return the sentence under the picture, HTML."""
        if self.file is None:
            from_file = 'from the file that <code>hx.view(…).save("race.html")</code> writes'
        else:
            link = html.escape(_relative_link(self.file))
            from_file = f'from the file <a href="{link}">{html.escape(self.file.name)}</a>'
        documentation = _documentation()
        more = f' <a href="{html.escape(documentation)}">Documentation</a>' if documentation else ""
        return (
            f"It plays where scripts may run: in a notebook that is trusted, and {from_file}.{more}"
        )


def _relative_link(file: Path) -> str:
    """Return the address of a file from the working folder, which is usually the notebook's."""
    try:
        return urllib.parse.quote(Path(os.path.relpath(file)).as_posix())
    except ValueError:  # Windows: on another drive
        return file.absolute().as_uri()


def _documentation() -> str | None:
    """Return the address of the documentation, None where no installed package states one."""
    try:
        urls = importlib.metadata.metadata("racing-hexapods").get_all("Project-URL") or []
    except importlib.metadata.PackageNotFoundError:
        return None
    pairs = (url.partition(", ") for url in urls)
    return next((address for name, _, address in pairs if name == "Documentation"), None)


def view(
    shown: Race | Training, *, title: str | None = None, clock: Clock | Sequence[Clock] = "paper"
) -> View:
    """Return a page that plays a race in 3D, in any browser and without a server.

    Args:
        shown: a race, or a training, which walks 50 steps alone.
        title: of the page; the names of the agents by default.
        clock: times the race: `paper`, `wall` or `free`; of several the page begins with the first,
            and offers a choice.

    Raises:
        UnknownName, InvalidInput: if an argument is not valid; the message names what is.
        TooLong: if the race does not fit into a page.

    Examples:
        >>> import hexapods as hx
        >>> race = hx.race(["greedy", "wave"], simulator="kinematic", steps=6)
        >>> page = hx.view(race, title="Greedy and Wave", clock=["paper", "free"])
        >>> page.save("race.html").exists()
        True
    """
    # Only here: viser takes longer to import than all else.
    from hexapods.exports.replay_page import replay_page  # noqa: PLC0415
    from hexapods.exports.stage_picture import stage_picture  # noqa: PLC0415

    clocks = [clock] if isinstance(clock, str) else [*clock]
    if not clocks:
        raise InvalidInput("clock is paper, wall or free, or several of them, not none")
    for name in clocks:
        check_clock(name)
    if title is not None and not isinstance(title, str):
        raise InvalidInput(f"title is a text, not {title!r}")
    if not isinstance(shown, Race | Training):
        raise InvalidInput(f"what can be viewed is a race or a training, not {shown!r}")
    shown_race = race([shown]) if isinstance(shown, Training) else shown
    title = title or _title(shown_race)
    replays = [_replay(shown_race, title, name) for name in dict.fromkeys(clocks)]
    picture = stage_picture(replays[0])
    encoded = [_encoded(replay, picture) for replay in replays]
    return View(title, b"".join(replay_page(encoded, title)).decode(), *picture)


def _replay(shown: Race, title: str, clock: Clock) -> Replay:
    config = shown.config
    scene = race_scene(config)
    show = RaceShow(scene, config.steps, clock, lambda: shown.recording, world=config.world)
    replay = Replay(show, RunLabel(None, title, replay=True))
    show.advance(0.0, None, run_ended=True)
    return replay


def _encoded(replay: Replay, picture: StagePicture) -> EncodedReplay:
    from hexapods.drawing.replay_encoding import encode_frames, encode_scene  # noqa: PLC0415

    return EncodedReplay(
        replay.plan(),
        lambda: encode_scene(replay),
        # The page asks twice: for the size, and to write it.
        cache(lambda level, number: encode_frames(replay, replay.segment_times_s(level, number))),
        lambda: picture,
    )


def _title(shown: Race) -> str:
    names = [lane.name for lane in race_scene(shown.config).lane_specs]
    return f"{', '.join(names)}: {shown.config.steps:,} steps"
