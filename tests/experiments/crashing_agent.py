"""An agent that kills its process or raises, in the trials that a file lists."""

import os
import signal
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NoReturn

import numpy as np

from hexapods.agents.protocol import Problem
from hexapods.domain.types import Action, Cells
from tests.own_agents import Restless

FOLDER = "HEXAPODS_TESTS_CRASHES"
"""Environment variable with the path of a folder.

Its file `crashes` has a trial's seed and its end per line; to `tried` each attempt is appended.
"""


class CrashingAgent(Restless):
    """Acts at random; in a listed trial it kills its process, exits or raises."""

    def __init__(self, rng: np.random.Generator, problem: Problem) -> None:
        super().__init__(rng, problem)
        self._seed = rng.bit_generator.seed_seq.entropy  # type: ignore[attr-defined]

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        folder = Path(os.environ[FOLDER])
        for line in (folder / "crashes").read_text("utf-8").splitlines():
            seed, end = line.split()
            if int(seed) == self._seed:
                with (folder / "tried").open("a", encoding="utf-8") as tried:
                    tried.write(line + "\n")
                _crash(end)
        return super().act(observation, legal)


def set_crashes(folder: Path, ends: Iterable[tuple[int, str]]) -> None:
    """Configure which trials crash, by seed, and how each ends: kill, exit or raise."""
    (folder / "tried").touch()
    (folder / "crashes").write_text("".join(f"{seed} {end}\n" for seed, end in ends), "utf-8")


def tries(folder: Path) -> list[str]:
    """Return how each attempt at a listed trial has ended so far."""
    return [line.split()[1] for line in (folder / "tried").read_text("utf-8").splitlines()]


def _crash(end: str) -> NoReturn:
    if end == "kill":
        os.kill(os.getpid(), signal.SIGKILL)
    if end == "exit":
        sys.exit("enough")
    raise RuntimeError("I tripped")
