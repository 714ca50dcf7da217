"""View a race in 3D, in a browser or a notebook, by a page that needs no server."""

import html
import os
import webbrowser
from dataclasses import dataclass
from pathlib import Path

import platformdirs

from hexapods.domain.errors import InvalidInput
from hexapods.files import path_of, write_atomically
from hexapods.races import Race, race
from hexapods.runs.clocks import Clock, check_clock
from hexapods.shows.race_show import RaceShow
from hexapods.shows.replay import Replay
from hexapods.shows.scene_spec import race_scene
from hexapods.shows.show import RunLabel
from hexapods.trainings import Training


@dataclass(frozen=True, repr=False)
class View:
    """A page that plays a race, as `view` returns it; a notebook shows it by itself.

    Attributes:
        title: of the page.
        page: the page, HTML.
    """

    title: str
    page: str

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the page to a file.

        Returns:
            the path.

        Raises:
            InvalidInput: if it is no path.
            OSError: if the file cannot be written.
        """
        target = path_of(path, "a file")
        write_atomically(target, self.page.encode())
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
        page = html.escape(self.page)
        return f'<iframe srcdoc="{page}" width="100%" height="480" style="border:0"></iframe>'


def view(shown: Race | Training, *, title: str | None = None, clock: Clock = "paper") -> View:
    """Return a page that plays a race in 3D, in any browser and without a server.

    Args:
        shown: a race, or a training, which walks 50 steps alone.
        title: of the page; the names of the agents by default.
        clock: times the race: `paper`, `wall` or `free`.

    Raises:
        UnknownName, InvalidInput: if an argument is not valid; the message names what is.
        TooLong: if the race does not fit into a page.

    Examples:
        >>> import hexapods as hx
        >>> race = hx.race(["greedy", "wave"], simulator="kinematic", steps=6)
        >>> page = hx.view(race, title="Greedy and Wave")
        >>> page.save("race.html").exists()
        True
    """
    # Only here: viser takes longer to import than all else.
    from hexapods.drawing.replay_encoding import encode_frames, encode_scene  # noqa: PLC0415
    from hexapods.exports.replay_page import replay_page  # noqa: PLC0415

    check_clock(clock)
    if title is not None and not isinstance(title, str):
        raise InvalidInput(f"title is a text, not {title!r}")
    if not isinstance(shown, Race | Training):
        raise InvalidInput(f"what can be viewed is a race or a training, not {shown!r}")
    shown_race = race([shown]) if isinstance(shown, Training) else shown
    config = shown_race.config
    scene, name = race_scene(config), title or _title(shown_race)
    show = RaceShow(scene, config.steps, clock, lambda: shown_race.recording, world=config.world)
    replay = Replay(show, RunLabel(None, name, replay=True))
    show.advance(0.0, None, run_ended=True)
    chunks = replay_page(
        replay.plan(),
        lambda: encode_scene(replay),
        lambda level, number: encode_frames(replay, replay.segment_times_s(level, number)),
        name,
    )
    return View(name, b"".join(chunks).decode())


def _title(shown: Race) -> str:
    names = [lane.name for lane in race_scene(shown.config).lane_specs]
    return f"{', '.join(names)}: {shown.config.steps:,} steps"
