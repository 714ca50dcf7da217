"""Videos of a recorded walk: another reader opens them, and they show the recorded poses."""

import io
import pickle
import sys
from dataclasses import replace

import av
import numpy as np
import pytest
from PIL import Image, ImageSequence

from hexapods.domain.errors import InvalidInput
from hexapods.exports import video
from hexapods.exports.options import VideoOptions
from hexapods.exports.recorded_walks import RecordedWalks
from hexapods.exports.video import render_video, shown_poses
from hexapods.extras import MissingExtra
from tests.exports.conftest import recorded_walks
from tests.stage.stage_parts import StageParts

pytestmark = pytest.mark.promises

SMALL = VideoOptions(width=160, height=120, fps=5, clock="free")
PICTURES = 11  # 6 steps of 0.32 s at 5 a second, and the end


def test_an_mp4_opens_in_another_reader_and_moves(raced: RecordedWalks) -> None:
    about = {"title": "A race", "clock": "free"}
    with av.open(io.BytesIO(render_video(raced, SMALL, "mp4", about=about)), "r") as video:
        stream = video.streams.video[0]
        assert video.metadata["title"] == "A race"
        assert "clock: free" in video.metadata["comment"]
        pictures = [frame.to_ndarray(format="rgb24").astype(int) for frame in video.decode(stream)]

    assert (stream.codec_context.name, stream.width, stream.height) == ("h264", 160, 120)
    assert stream.average_rate == 5
    assert len(pictures) == PICTURES
    blue = [(picture[..., 2] - picture[..., 0] > 60).sum() for picture in pictures]
    assert min(blue) > 40, "greedy's robot is blue"
    assert np.abs(pictures[0] - pictures[-1]).max() > 60


def test_a_gif_opens_in_another_reader(raced: RecordedWalks) -> None:
    options = VideoOptions(160, 120, 5, clock="free")
    with Image.open(io.BytesIO(render_video(raced, options, "gif"))) as video:
        assert (video.format, video.size) == ("GIF", (160, 120))
        assert len([*ImageSequence.Iterator(video)]) == PICTURES
        assert video.info["duration"] == 200


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
    walks = recorded_walks(parts, run)
    times_s = shown_poses(walks, VideoOptions(fps=1), 1000).times_s
    assert times_s[-1] == pytest.approx(700 * 0.32)
    assert len(times_s) == pytest.approx(520 * 0.32, abs=2)


def test_a_long_walk_is_shown_whole_but_faster_unless_its_speed_is_chosen(
    parts: StageParts, raced: RecordedWalks
) -> None:
    assert shown_poses(raced, SMALL, 900).times_s[1] == pytest.approx(1 / 5), "at its own speed"
    run = parts.finished_training(steps=700)
    walks = recorded_walks(parts, run)
    times_s = shown_poses(walks, VideoOptions(), 900).times_s
    assert 800 < len(times_s) <= 900
    assert times_s[-1] == pytest.approx(700 * 0.32)
    with pytest.raises(InvalidInput, match="more than 900 frames; choose a higher speed"):
        shown_poses(walks, VideoOptions(playback_speed=1.0), 900)


def test_what_cannot_be_rendered_is_refused(
    raced: RecordedWalks, monkeypatch: pytest.MonkeyPatch
) -> None:
    for wrong, words in (
        ({"width": 63}, "width must be an even number of pixels from 64 to 1,920"),
        ({"height": 121}, "height must be an even number"),
        ({"fps": 0}, "fps must be a whole number from 1 to 60"),
        ({"playback_speed": float("nan")}, "playback_speed must be a number from 0.05 to 64"),
    ):
        with pytest.raises(InvalidInput, match=words):
            VideoOptions(**wrong)
    with pytest.raises(InvalidInput, match="more than 5 frames; choose a higher speed"):
        shown_poses(raced, replace(SMALL, playback_speed=1.0), 5)
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    monkeypatch.setitem(sys.modules, "mujoco.egl", None)
    with pytest.raises(MissingExtra, match="apt-get install libegl1 libgl1-mesa-dri") as error:
        render_video(raced, SMALL, "mp4")
    assert str(pickle.loads(pickle.dumps(error.value))) == str(error.value)
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(MissingExtra, match=r'pip install "racing-hexapods\[video\]"'):
        render_video(raced, SMALL, "mp4")
