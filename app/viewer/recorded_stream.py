"""A race as a film: a `.viser` file that the viewer's page plays, with a bar to move in it."""

from collections.abc import Sequence

from app.runs.clocks import Clock
from app.runs.config import RaceConfig
from app.runs.recording import LaneRecording
from app.stage.race_show import RaceShow
from app.stage.scene_spec import race_scene
from app.stage.show import RunLabel
from app.viewer.in_process import in_process_viser
from app.viewer.scene import StageScene

FRAMES_PER_S = 30
LONGEST_S = 90.0
"""A longer film is shown faster throughout, so that a file stays a few MB."""
_LAST_PICTURE_S = 2.0


def recorded_stream(
    config: RaceConfig, lanes: Sequence[LaneRecording], name: str = "Race", clock: Clock = "paper"
) -> bytes:
    """The race as the stage shows it, photo finish and all, seen with the leader.

    The format is that of the installed version of viser, which the file names.

    Args:
        config: the race.
        lanes: its whole recording.
        name: of the race.
        clock: which it is timed by.
    """
    show = RaceShow(race_scene(config), config.steps, clock, lambda: lanes)
    show.advance(0.0, None, run_ended=True)
    length_s = show.duration_s or 0.0
    speed = length_s / LONGEST_S if length_s > 2 * LONGEST_S else None
    frame_s, run_label = 1 / FRAMES_PER_S, RunLabel(None, name)
    with in_process_viser() as server:
        scene = StageScene(server)
        scene.draw(show.frame(run_label), now=0.0)
        serializer = server.get_scene_serializer()
        now = 0.0
        while not show.ended:
            serializer.insert_sleep(frame_s)
            now += frame_s
            show.advance(frame_s, speed, run_ended=True)
            scene.draw(show.frame(run_label), now)
            scene.centre("leader")
        serializer.insert_sleep(_LAST_PICTURE_S)
        return serializer.serialize()
