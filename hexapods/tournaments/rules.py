"""Rules of a tournament, and the secret draws on which its entries are judged."""

import hashlib
import re
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from annotated_types import Ge, Le

from hexapods.domain.errors import InvalidInput
from hexapods.domain.records import Record
from hexapods.domain.robot import AnyRobot
from hexapods.domain.settings import Setting, declared_fields
from hexapods.domain.world import UNDISTURBED, parse_world
from hexapods.experiments.statistics import MIN_RESAMPLED
from hexapods.runs.config import PracticeSteps, Seed, WalkingProblem

MAX_DRAWS = 100
MAX_BUDGET = 5_000
"""Steps of practice on a draw: a judge takes seconds for it."""
_SECRET = re.compile("[0-9a-f]{64}")


@dataclass(frozen=True, kw_only=True)
class TournamentRules(WalkingProblem):
    """Rules of a tournament: the walking problem, the secret draws, and what an entry may choose.

    Attributes:
        steps: budget: the most steps that an entry practises on each draw.
        draws: number of secret draws; each is a seed and a world.
        worlds: names of worlds, or disturbances as on the command line, of which each draw has one.
        robots: creatures that an entry may choose beside `robot`, each in the gait that suits it.
        tables: whether a trained table may enter.

    Raises:
        UnknownName, InvalidInput: if a value is invalid.
    """

    steps: PracticeSteps = 500
    draws: Annotated[
        int,
        Ge(MIN_RESAMPLED),
        Le(MAX_DRAWS),
        Setting(title="Draws", help="Secret seeds and worlds on which each entry is judged."),
    ] = 20
    worlds: tuple[str, ...] = ("flat",)
    robots: tuple[AnyRobot, ...] = ()
    tables: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        setting = declared_fields(TournamentRules)["draws"]
        setting.check(self.draws)
        if self.steps > MAX_BUDGET:
            raise InvalidInput(f"steps must be from 1 to {MAX_BUDGET} in a tournament")
        if self.world != UNDISTURBED:
            raise InvalidInput(
                "a tournament has worlds, of which each draw has one; leave out disturbances"
            )
        if not self.worlds:
            raise InvalidInput("worlds must name at least one")
        for name in self.worlds:
            # A robot of any kind that may enter must be able to walk in it.
            for robot in (self.robot, *self.robots):
                parse_world(name).check(robot, self.simulator, None)


@dataclass(frozen=True)
class Draw(Record):
    """A seed and a world on which all entries are judged, so that they can be compared in pairs.

    Attributes:
        seed: of practice and race.
        world: name of the world, or its disturbances.
    """

    seed: Seed
    world: str


def commitment_of(secret: str) -> str:
    """Return what is published of a secret before the end: its SHA-256, hexadecimal.

    Who has it can check after the end that the draws were fixed at the beginning.

    Raises:
        InvalidInput: if the secret is not 64 hexadecimal digits.
    """
    _check_secret(secret)
    return hashlib.sha256(secret.encode()).hexdigest()


def draws_of(rules: TournamentRules, secret: str) -> tuple[Draw, ...]:
    """Return the draws that follow from a secret.

    Args:
        rules: number of draws and their worlds, of which each occurs as often as any other, but
            for the remainder.
        secret: 64 hexadecimal digits.

    Raises:
        InvalidInput: if the secret is not 64 hexadecimal digits.
    """
    _check_secret(secret)
    rng = np.random.default_rng(np.random.SeedSequence(int(secret, 16)))
    # Seeds have 53 bits, so that JSON parsers with float numbers preserve them.
    seeds = rng.integers(0, 2**53, rules.draws)
    worlds = rng.permutation([index % len(rules.worlds) for index in range(rules.draws)])
    return tuple(
        Draw(int(seed), rules.worlds[world]) for seed, world in zip(seeds, worlds, strict=True)
    )


def _check_secret(secret: str) -> None:
    if not _SECRET.fullmatch(secret):
        raise InvalidInput("the secret of a tournament must be 64 hexadecimal digits, 0 to f")
