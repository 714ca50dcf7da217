"""Digests of results: of each agent and each robot, to the last bit.

Run as a program it prints them as JSON, for other Pythons and other instructions of the processor.
"""

import hashlib
import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import astuple, is_dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import hexapods as hx
from hexapods.agents.registry import BUILT_IN, learns
from hexapods.domain.model_robot import model_robot
from hexapods.domain.robot import PRESETS, Robot
from hexapods.runs.config import SimulatorName, WalkingProblem
from hexapods.runs.preview import preview
from tests.model_robots import model_of

STEPS = 100


ROOT = Path(__file__).parent.parent
COMMON_INSTRUCTIONS = {
    "NPY_DISABLE_CPU_FEATURES": "X86_V3 X86_V4 AVX512_ICL AVX512_SPR",
    "OPENBLAS_CORETYPE": "Haswell",
}
"""Environment in which NumPy takes the same instructions on every x86-64 processor with AVX2."""


def digests() -> dict[str, str]:
    """Return by the name of each result the beginning of its SHA-256."""
    return {name: _digest(make()) for name, make in results()}


def digests_of(python: str | Path = sys.executable, **environment: str) -> dict[str, str]:
    """Return the digests by another Python, or in another environment.

    Args:
        python: its command; it has what requirements.lock names.
        environment: variables beside those of this process.
    """
    done = subprocess.run(
        [python, "-m", "tests.digests"],
        cwd=ROOT,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    by_name: dict[str, str] = json.loads(done.stdout)
    return by_name


def results() -> Iterator[tuple[str, Callable[[], Any]]]:
    """Yield the name of each result, and what computes it."""
    yield "training", partial(_training, "q-learning", "mujoco")
    yield "race", _race
    for agent in BUILT_IN:
        yield agent, partial(_practice_and_race, agent)
    for name, robot in PRESETS.items():
        yield f"robot {name}", partial(_walk, robot)
    yield "robot of a file", _walk_of_model


def _training(agent: str, simulator: SimulatorName) -> tuple[Any, ...]:
    trained = hx.train(agent, simulator=simulator, steps=STEPS, seed=3)
    return trained.table.arrays, trained.curve


def _race() -> Any:
    raced = hx.race(["greedy", "linear-model", "random-walk"], steps=6, seed=1, tolerance=0.03)
    return raced.recording_sha256, [_motions(lane) for lane in raced.recording]


def _practice_and_race(agent: str) -> tuple[Any, ...]:
    """Practise on the kinematic simulator if the agent learns, and race there."""
    if not learns(agent):
        raced = hx.race([agent], simulator="kinematic", steps=2, seed=1)
        return (_motions(raced.recording[0]),)
    trained = hx.train(agent, simulator="kinematic", steps=STEPS, seed=3)
    raced = hx.race([trained], simulator="kinematic", steps=6, seed=1)
    return trained.table.arrays, trained.curve, _motions(raced.recording[0])


def _walk(robot: Robot) -> tuple[Any, ...]:
    """Take three greedy steps in MuJoCo, and say what is known beforehand."""
    gait = "one-by-one"
    raced = hx.race(["greedy"], robot=robot, gait=gait, steps=3)
    previewed = preview(WalkingProblem(robot=robot, gait=gait))
    return _motions(raced.recording[0]), previewed.law_m, previewed.mass_kg, previewed.margin_m


def _walk_of_model() -> tuple[Any, ...]:
    return _walk(model_robot(model_of(PRESETS["stiff"]), "of a file"))


def _motions(lane: Any) -> list[Any]:
    """Return what each step of a recorded lane gave, in the files' precision, and its distance."""
    return [[step.distance_m, step.reward_m, step.motion] for step in lane.steps]


def _digest(value: Any) -> str:
    digest = hashlib.sha256()
    for chunk in _parts(value):
        digest.update(chunk)
    return digest.hexdigest()[:12]


def _parts(value: Any) -> Iterator[bytes]:
    """Yield the bits of a value; of an array the little-endian ones."""
    if isinstance(value, np.ndarray):
        yield f"{value.dtype.kind}{value.shape}".encode()
        yield value.astype(value.dtype.newbyteorder("<")).tobytes()
    elif isinstance(value, dict):
        for key in sorted(value):
            yield key.encode()
            yield from _parts(value[key])
    elif isinstance(value, list | tuple):
        for member in value:
            yield from _parts(member)
    elif is_dataclass(value) and not isinstance(value, type):
        yield from _parts(astuple(value))
    else:
        yield (float(value).hex() if isinstance(value, int | float) else repr(value)).encode()


if __name__ == "__main__":
    json.dump(digests(), sys.stdout)
