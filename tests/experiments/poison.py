"""An agent that is the end of whoever runs it, in the trials that a file names."""

import os
import signal
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NoReturn

import numpy as np

from app.agents.protocol import Problem
from app.domain.types import Action, Cells
from tests.own_agents import Restless

FOLDER = "HEXAPODS_TESTS_POISON"
"""The environment variable that names a folder: in it the file `poisoned`, a seed of a trial and
what becomes of it a line; and `tried`, to which each try is added."""


class Poisonous(Restless):
    """Goes anywhere; in a poisoned trial it ends its process, or breaks."""

    def __init__(self, rng: np.random.Generator, problem: Problem) -> None:
        super().__init__(rng, problem)
        self._seed = rng.bit_generator.seed_seq.entropy  # type: ignore[attr-defined]

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        folder = Path(os.environ[FOLDER])
        for line in (folder / "poisoned").read_text("utf-8").splitlines():
            seed, end = line.split()
            if int(seed) == self._seed:
                with (folder / "tried").open("a", encoding="utf-8") as tried:
                    tried.write(line + "\n")
                _meet(end)
        return super().act(observation, legal)


def poison(folder: Path, ends: Iterable[tuple[int, str]]) -> None:
    """Say which trials are poisoned, by their seeds, and how they end: kill, exit or raise."""
    (folder / "tried").touch()
    (folder / "poisoned").write_text("".join(f"{seed} {end}\n" for seed, end in ends), "utf-8")


def tries(folder: Path) -> list[str]:
    """How the trials ended that were tried so far."""
    return [line.split()[1] for line in (folder / "tried").read_text("utf-8").splitlines()]


def _meet(end: str) -> NoReturn:
    if end == "kill":
        os.kill(os.getpid(), signal.SIGKILL)
    if end == "exit":
        sys.exit("enough")
    raise RuntimeError("I tripped")
