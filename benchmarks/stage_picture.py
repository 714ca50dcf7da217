"""Cost of the picture of the stage: `python benchmarks/stage_picture.py ../before . --rounds 6`.

Each argument is the folder of a checkout with its `.venv`, or a page of a replay as *Export* writes
it. In a checkout its own code computes the same short race, with exact kinematics, and writes the
page. Headless Chromium, which here draws without a GPU, plays the pages in turns in every theme:
each picture is drawn as soon as the one before is, so that frames per second are a bound of what
the stage can show. A round is one page after the other, and the order changes from round to round,
so that a machine that is busy meanwhile is so for all.

Prints one JSON object: for each theme the frames per second and the processor time of all processes
of the browser for a picture [ms], medians over the rounds, the ratio of each page's to the first
page's, as the median of the ratios of the rounds with its quartiles, and the load of the machine
before and after. Only ratios are to be compared between machines.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import psutil
from playwright.sync_api import Browser, Page, sync_playwright

sys.path.insert(0, str(Path(__file__).parents[1]))

from tests.install_browser import HOW_TO_GET_ONE, find_browser

_OPTIONS = (
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
)
_THEMES = ("light", "dark")
_STEPS = 30
_WRITE_PAGE = """
import sys, time
from pathlib import Path
import numpy as np
from hexapods.assembly import build_walkers
from hexapods.drawing.replay_encoding import encode_frames, encode_scene
from hexapods.exports.replay_page import replay_page
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.racing import record_race
from hexapods.shows.race_show import RaceShow
from hexapods.shows.replay import Replay
from hexapods.shows.scene_spec import race_scene
from hexapods.shows.show import RunLabel

out, steps = Path(sys.argv[1]), int(sys.argv[2])
lanes = tuple(LaneConfig(agent=agent) for agent in ("q-learning", "greedy", "two-step"))
config = RaceConfig(gait="left-right-vertical", simulator="kinematic", lanes=lanes, steps=steps)
recordings = []
for recordings in record_race(build_walkers(config, [None] * len(lanes)), config, lambda: 0.0):
    pass
show = RaceShow(race_scene(config), steps, "paper", lambda: recordings)
show.update(run_ended=True)
replay = Replay(show, RunLabel("race", "Race"))
segment = lambda level, number: encode_frames(replay, replay.segment_times_s(level, number))
chunks = replay_page(replay.plan(), lambda: encode_scene(replay), segment, "Race")
out.write_bytes(b"".join(chunks))
"""
"""What a checkout's own Python does: to a file, a race of so many steps."""
_IS_DRAWN = """() => window.hexapods && window.__viserMutable
    && Object.keys(window.__viserMutable.nodeRefFromName).some((name) => /torso$/.test(name))"""
_DRAW = """async (seconds) => {
    const { scene } = window.__viserMutable;
    window.drawn ??= (() => {
        const after = scene.onAfterRender;
        const drawn = { count: 0 };
        scene.onAfterRender = (...parts) => { drawn.count += 1; after.apply(scene, parts); };
        return drawn;
    })();
    window.hexapods.seek(1);
    window.hexapods.play();
    const begun = performance.now();
    const first = window.drawn.count;
    while (performance.now() - begun < 1000 * seconds) {
        if (window.hexapods.paused) { window.hexapods.seek(1); window.hexapods.play(); }
        window.__viserMutable.requestRender();
        await new Promise(requestAnimationFrame);
    }
    return { frames: window.drawn.count - first, elapsed_s: (performance.now() - begun) / 1000 };
}"""
"""Plays the run, and draws again and again for some seconds; returns how often that was."""
_READY_WITHIN_MS = 120_000


def page_of(source: Path, folder: Path, number: int, steps: int) -> Path:
    """Return the replay page of a checkout, which writes it, or the page that is named.

    Raises:
        SystemExit: if it is neither, or the checkout could not write one.
    """
    if source.is_file():
        return source.resolve()
    python = source / ".venv" / "bin" / "python"
    if not python.exists():
        raise SystemExit(f"{source} is neither a replay page nor a checkout with a .venv")
    out = folder / f"page{number}.html"
    command = [str(python.absolute()), "-c", _WRITE_PAGE, str(out), str(steps)]
    if subprocess.run(command, cwd=source, check=False).returncode:
        raise SystemExit(f"{source} could not write a replay page; it says why above")
    return out


def processor_s(pid: int) -> float:
    """Return the processor time of a process and of all below it [s]."""
    total = 0.0
    for process in (psutil.Process(pid), *psutil.Process(pid).children(recursive=True)):
        try:
            times = process.cpu_times()
        except psutil.NoSuchProcess:
            continue
        total += times.user + times.system
    return total


def browser_pid() -> int:
    """Return the process of the browser that was started last by this one."""
    started = psutil.Process().children(recursive=True)
    browsers = [p for p in started if any("--use-angle" in part for part in p.cmdline())]
    return max(browsers, key=lambda process: len(process.children(recursive=True))).pid


def measured(page: Page, seconds: float) -> tuple[float, float]:
    """Return the frames per second of a page that is played, and the processor time of each [s]."""
    pid = browser_pid()
    before_s = processor_s(pid)
    drawn: dict[str, float] = page.evaluate(_DRAW, seconds)
    spent_s = processor_s(pid) - before_s
    return drawn["frames"] / drawn["elapsed_s"], spent_s / max(1.0, drawn["frames"])


def opened(browser: Browser, file: Path, theme: str, size: tuple[int, int]) -> Page:
    """Return a page that shows the stage."""
    page = browser.new_page(viewport={"width": size[0], "height": size[1]})
    page.goto(f"{file.as_uri()}?theme={theme}")
    page.wait_for_function(_IS_DRAWN, timeout=_READY_WITHIN_MS)
    page.evaluate(_DRAW, 2.0)  # shaders are compiled, and segments unpacked
    return page


def ratios(values: Sequence[float], first: Sequence[float]) -> dict[str, float]:
    """Return the median and the quartiles of the ratios of rounds."""
    shares = [value / other for value, other in zip(values, first, strict=True)]
    low, middle, high = (
        statistics.quantiles(shares, n=4, method="inclusive") if len(shares) > 1 else shares * 3
    )
    return {"median": round(middle, 3), "low": round(low, 3), "high": round(high, 3)}


def report(names: Sequence[str], rounds: Sequence[Sequence[tuple[float, float]]]) -> dict[str, Any]:
    """Return the figures of a theme, by page, from those of each round."""
    figures = {}
    first_fps, first_cpu = ([values[0][n] for values in rounds] for n in (0, 1))
    for number, name in enumerate(names):
        fps, cpu = ([values[number][n] for values in rounds] for n in (0, 1))
        figures[name] = {
            "frames_per_s": round(statistics.median(fps), 2),
            "processor_ms": round(1000 * statistics.median(cpu), 1),
            "frames_per_s_ratio": ratios(fps, first_fps),
            "processor_ratio": ratios(cpu, first_cpu),
        }
    return figures


def main() -> None:
    """Measure the pages that are named on the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("sources", nargs="+", type=Path, metavar="CHECKOUT_OR_PAGE")
    parser.add_argument("--rounds", type=int, default=6)
    parser.add_argument("--seconds", type=float, default=8.0, help="for a page and a round")
    parser.add_argument("--size", default="1280x720", help="of the window [px]")
    parser.add_argument("--steps", type=int, default=_STEPS, help="of the race that is played")
    options = parser.parse_args()
    width, height = (int(side) for side in options.size.split("x"))
    browser_path = find_browser()
    if browser_path is None:
        raise SystemExit(HOW_TO_GET_ONE)
    names = [str(source) for source in options.sources]
    load_before = os.getloadavg()
    figures = {}
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        files = [
            page_of(source, Path(folder), number, options.steps)
            for number, source in enumerate(options.sources)
        ]
        for theme in _THEMES:
            rounds = []
            for number in range(options.rounds):
                turns = list(enumerate(files))
                found: dict[int, tuple[float, float]] = {}
                for index, file in turns if number % 2 == 0 else turns[::-1]:
                    # A browser of its own, since pages that are not seen are drawn too.
                    with playwright.chromium.launch(
                        executable_path=browser_path, args=list(_OPTIONS)
                    ) as browser:
                        page = opened(browser, file, theme, (width, height))
                        found[index] = measured(page, options.seconds)
                rounds.append([found[index] for index in range(len(files))])
            figures[theme] = report(names, rounds)
    print(
        json.dumps(
            {
                "at": time.strftime("%Y-%m-%d %H:%M"),
                "size": options.size,
                "rounds": options.rounds,
                "load_before": [round(load, 1) for load in load_before],
                "load_after": [round(load, 1) for load in os.getloadavg()],
                "themes": figures,
            },
            indent=2,
        )
    )


if __name__ == "__main__":
    main()
