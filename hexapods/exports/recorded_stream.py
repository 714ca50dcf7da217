"""Export of a race as a `.viser` file, which the viewer's page plays with a seek bar."""

from collections.abc import Callable, Sequence

from hexapods.drawing.scene import StageScene
from hexapods.drawing.viser_internals.server import in_process_viser
from hexapods.runs.clocks import Clock
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.recording import LaneRecording
from hexapods.shows.race_show import Original, RaceShow
from hexapods.shows.replay import FRAMES_PER_S
from hexapods.shows.scene_spec import race_scene
from hexapods.shows.show import RunLabel

MAX_LENGTH_S = 90.0
"""Longest duration at normal speed [s]; longer races are played faster, so files stay small."""
_LAST_FRAME_S = 2.0


def recorded_stream(
    config: RaceConfig,
    lanes: Sequence[LaneRecording],
    name: str = "Race",
    clock: Clock = "paper",
    original: Original | None = None,
    *,
    check: Callable[[], None] = lambda: None,
) -> bytes:
    """Render a race as the stage shows it, photo finish included, with the camera on the leader.

    Args:
        config: the race.
        lanes: its complete recording.
        name: name of the race.
        clock: clock that times it.
        original: the race from which it branched off, if it is known.
        check: raises once nobody needs the file any more; called for each frame.

    Returns:
        the file in the format of the installed viser, whose version is part of the file.
    """
    spec = race_scene(config)
    show = RaceShow(spec, config.steps, clock, lambda: lanes, world=config.world, original=original)
    show.advance(0.0, None, run_ended=True)
    duration_s = show.duration_s or 0.0
    speed = duration_s / MAX_LENGTH_S if duration_s > 2 * MAX_LENGTH_S else None
    frame_s, run_label = 1 / FRAMES_PER_S, RunLabel(None, name)
    with in_process_viser() as server:
        scene = StageScene(server)
        scene.draw(show.frame(run_label), now=0.0)
        serializer = server.get_scene_serializer()
        now = 0.0
        while not show.ended:
            check()
            serializer.insert_sleep(frame_s)
            now += frame_s
            show.advance(frame_s, speed, run_ended=True)
            scene.draw(show.frame(run_label), now)
            scene.centre_world_on("leader")
        serializer.insert_sleep(_LAST_FRAME_S)
        return serializer.serialize()
