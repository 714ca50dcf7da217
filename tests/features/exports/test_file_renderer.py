"""Large files are rendered one at a time, in a process that ends with the renderer."""

import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path

import psutil
import pytest
from starlette.testclient import TestClient

from app.features.exports.file_renderer import FileRenderer
from app.server import create_app
from app.settings import Settings
from app.storage.errors import Busy
from hexapods import processes
from hexapods.domain.errors import HexapodError, InvalidInput
from hexapods.exports.export_format import Execution
from hexapods.exports.options import VideoOptions
from hexapods.exports.recorded_walks import RecordedWalks
from hexapods.exports.video import render_video
from tests.jobs.waiting import wait_until
from tests.storage.stores import temporary_store
from tests.timeouts import LONG_S

SMALL = VideoOptions(width=160, height=120, fps=5, clock="free")


def rendered_by(renderer: FileRenderer, walks: RecordedWalks, options: VideoOptions) -> bytes:
    return render_video(walks, options, "mp4", Execution(write_file=renderer.render))


def write_name(file: Path) -> None:
    file.write_text(file.name)


def test_a_file_is_rendered_until_the_server_ends(tmp_path: Path) -> None:
    with temporary_store() as store:
        app = create_app(Settings(data=tmp_path), store)
        with TestClient(app, base_url="http://localhost:8000"):
            renderer = app.state.services.of(FileRenderer)
            assert renderer.render(write_name, "walk.txt") == b"walk.txt"
        with pytest.raises(Busy, match="the server is stopping"):
            renderer.render(write_name, "walk.txt")


@pytest.mark.promises
def test_a_video_that_is_rendered_ends_with_the_renderer(
    raced: RecordedWalks, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    renderer = FileRenderer()
    long = replace(SMALL, width=1920, height=1080, playback_speed=0.05)
    with ThreadPoolExecutor(1) as threads:
        rendered = threads.submit(rendered_by, renderer, raced, long)
        wait_until(lambda: [*tmp_path.rglob("video.mp4")])
        (worker,) = map(psutil.Process, renderer._pool.pids)
        worker_and_encoder = [worker, *worker.children()]
        assert len(worker_and_encoder) == 2
        with pytest.raises(Busy, match="another video is being rendered"):
            rendered_by(renderer, raced, SMALL)
        renderer.close()
        with pytest.raises(Busy, match="one of them ended"):
            rendered.result()
    assert [*tmp_path.iterdir()] == []
    assert psutil.wait_procs(worker_and_encoder, LONG_S)[1] == []
    with pytest.raises(Busy, match="the server is stopping"):
        rendered_by(renderer, raced, SMALL)


@pytest.mark.promises
def test_a_video_that_takes_too_long_or_cannot_be_encoded_fails_alone(
    raced: RecordedWalks, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    encoder = tmp_path / "encoder"
    encoder.write_text(f"#!/bin/sh\necho $$ > {tmp_path / 'pid'}\nexec sleep 600")
    encoder.chmod(0o700)
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", str(encoder))
    # The fork server has the environment that was there when it was started.
    monkeypatch.setattr(processes, "process_context", lambda: get_context("spawn"))
    stuck = FileRenderer(timeout_s=2.0)
    with pytest.raises(Busy, match="it took over 2 s"):
        rendered_by(stuck, raced, SMALL)
    assert not stuck._rendering.locked()
    pid = (tmp_path / "pid").read_text() if (tmp_path / "pid").exists() else ""
    wait_until(lambda: not pid or not psutil.pid_exists(int(pid)))
    stuck.close()
    encoder.write_text("#!/bin/sh\nexit 1")
    renderer = FileRenderer()
    with pytest.raises(HexapodError, match="a video failed: OSError") as failure:
        rendered_by(renderer, raced, SMALL)
    assert not isinstance(failure.value, InvalidInput)
    renderer.close()
