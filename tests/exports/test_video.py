"""Films of a recorded walk: another reader opens them, and they show the recorded poses."""

import io
import sys

import av
import numpy as np
import pytest
from PIL import Image, ImageSequence

from app.domain.errors import InvalidInput
from app.exports import video
from app.exports.extras import MissingExtra
from app.exports.recorded_lanes import RecordedWalks, recorded_walks
from app.exports.video import VideoOptions, check_length, render_video
from app.exports.video_renderer import VideoRenderer
from app.storage.errors import Busy
from tests.stage.stage_parts import StageParts

SMALL = VideoOptions(width=160, height=120, fps=5, clock="free")
PICTURES = 11  # 6 steps of 0.32 s at 5 a second, and the end


def test_an_mp4_opens_in_another_reader_and_moves(raced: RecordedWalks) -> None:
    with av.open(io.BytesIO(VideoRenderer().render(raced, SMALL)), "r") as film:
        stream = film.streams.video[0]
        pictures = [frame.to_ndarray(format="rgb24").astype(int) for frame in film.decode(stream)]

    assert (stream.codec_context.name, stream.width, stream.height) == ("h264", 160, 120)
    assert stream.average_rate == 5
    assert len(pictures) == PICTURES
    blue = [(one[..., 2] - one[..., 0] > 60).sum() for one in pictures]
    assert min(blue) > 40, "greedy's robot is blue"
    assert np.abs(pictures[0] - pictures[-1]).max() > 60


def test_a_gif_opens_in_another_reader(raced: RecordedWalks) -> None:
    options = VideoOptions(".gif", 160, 120, 5, clock="free")
    with Image.open(io.BytesIO(render_video(raced, options))) as film:
        assert (film.format, film.size) == ("GIF", (160, 120))
        assert len([*ImageSequence.Iterator(film)]) == PICTURES
        assert film.info["duration"] == 200


def test_pictures_show_the_recorded_poses(raced: RecordedWalks) -> None:
    step_s = raced.problem.robot.step_s
    track = video._Track(raced.lanes[1], step_s, "free")
    assert np.array_equal(track.pose(0), raced.lanes[1].start_qpos)
    for index in range(6):
        motion = raced.lanes[1].motion(index)
        for frame in (3, -1):
            time_s = index * step_s + float(motion.time_s[frame])
            assert track.pose(time_s) == pytest.approx(motion.qpos[frame], abs=1e-4)


def test_a_gap_in_a_practice_is_left_out(parts: StageParts) -> None:
    run = parts.finished_training(steps=700)
    walks = recorded_walks(parts.store.find(run.id), parts.recordings)
    times_s = video._times_s(walks, VideoOptions(fps=1), 1000)
    assert times_s[-1] == pytest.approx(700 * 0.32)
    assert len(times_s) == pytest.approx(520 * 0.32, abs=2)


def test_what_cannot_be_rendered_is_refused(
    raced: RecordedWalks, monkeypatch: pytest.MonkeyPatch
) -> None:
    for wrong, words in (
        ({"width": 63}, "width must be from 64 to 1920"),
        ({"height": 121}, "must be even"),
        ({"fps": 0}, "fps must be from 1 to 60"),
        ({"speed": float("nan")}, "speed must be from"),
    ):
        with pytest.raises(InvalidInput, match=words):
            VideoOptions(**wrong)
    with pytest.raises(InvalidInput, match="more than 5 pictures; choose a higher speed"):
        check_length(raced, SMALL, 5)
    renderer = VideoRenderer()
    renderer._rendering.acquire()
    with pytest.raises(Busy, match="another film is being rendered"):
        renderer.render(raced, SMALL)
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    monkeypatch.setitem(sys.modules, "mujoco.egl", None)
    with pytest.raises(MissingExtra, match="apt-get install libegl1 libgl1-mesa-dri"):
        render_video(raced, SMALL)
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(MissingExtra, match=r"pip install 'racing-hexapods\[video\]'"):
        render_video(raced, SMALL)
