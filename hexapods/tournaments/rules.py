"""Rules of a tournament, and the secret draws on which its entries are judged."""

import hashlib
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from annotated_types import Ge, Le

from hexapods.domain.creatures import own_gait
from hexapods.domain.errors import InvalidInput, Unreachable, about
from hexapods.domain.gait import AnyGait, resolve
from hexapods.domain.kinematics import check_reach
from hexapods.domain.records import Record
from hexapods.domain.robot import AnyRobot, Robot
from hexapods.domain.settings import Setting
from hexapods.domain.world import UNDISTURBED, lasting_world
from hexapods.experiments.statistics import MIN_RESAMPLED
from hexapods.runs.config import RACE_STEPS, Seed, WalkingProblem

MIN_DRAWS, MAX_DRAWS = MIN_RESAMPLED, 100
MAX_WORLDS = MAX_ROBOTS = 20
MAX_ENTRIES = 300
"""Entries of a tournament, with the references: each is compared with each other."""
MAX_BUDGET = 5_000
"""Steps of practice on a draw: a judge takes seconds for it."""
MIN_TRANSITIONS, MAX_TRANSITIONS = 500, 100_000
DEFAULT_TRANSITIONS = 40_000
"""Two steps ahead need 7,800 with three pairs of legs, three steps 94,200. Of rules that do not say
it, as there was no choice before, it is the limit."""
_SECRET = re.compile("[0-9a-f]{64}")


@dataclass(frozen=True, kw_only=True)
class TournamentRules(WalkingProblem):
    """Rules of a tournament: the walking problem, the secret draws, and what an entry may choose.

    Attributes:
        steps: budget: the most steps that an entry practises on each draw.
        draws: number of secret draws; each is a seed and a world.
        worlds: names of worlds, or disturbances as on the command line, of which each draw has one.
        robots: creatures that an entry may choose beside `robot`.
        gaits: gait of each of `robots`, in order; empty for those that suit them, which are then
            written out, since what suits a stored robot is not known everywhere.
        tables: whether a trained table may enter.
        transitions: most transitions that a search simulates on each draw; a time would depend on
            the machine.

    Raises:
        UnknownName, InvalidInput: if a value is invalid.
        Unreachable: if a robot's legs cannot reach the grid.
    """

    steps: Annotated[
        int,
        Ge(1),
        Le(MAX_BUDGET),
        Setting(
            title="Most steps of practice",
            help="The most that an entry practises on each draw.",
            unit="steps",
        ),
    ] = 500
    draws: Annotated[
        int,
        Ge(MIN_DRAWS),
        Le(MAX_DRAWS),
        Setting(
            title="Secret seeds", help="Draws on which each entry is judged; each has a world."
        ),
    ] = 20
    worlds: tuple[str, ...] = ("flat",)
    robots: tuple[AnyRobot, ...] = ()
    gaits: tuple[AnyGait, ...] = ()
    tables: bool = False
    transitions: Annotated[
        int,
        Ge(MIN_TRANSITIONS),
        Le(MAX_TRANSITIONS),
        Setting(
            title="Transitions a search may simulate",
            help="The most on each draw; over it, the search has failed there.",
        ),
    ] = DEFAULT_TRANSITIONS

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.world != UNDISTURBED:
            raise InvalidInput(
                "a tournament has worlds, of which each draw has one; leave out disturbances"
            )
        self._check_transitions()
        with about("robots"):
            self._check_robots()
        with about("worlds"):
            self._check_worlds()

    def _check_transitions(self) -> None:
        """Check that greedy, which is judged in every tournament, can walk to the end."""
        actions = len(self.resolved_gait.groups) * (len(self.grid) - 1)
        fewest = RACE_STEPS * actions
        if self.transitions < fewest:
            raise InvalidInput(
                f"transitions must be at least {fewest:,} here, as greedy simulates {actions} on "
                f"each of its {RACE_STEPS} steps, not {self.transitions:,}",
                field="transitions",
            )

    def _check_robots(self) -> None:
        if len(self.robots) > MAX_ROBOTS:
            raise InvalidInput(f"robots must be at most {MAX_ROBOTS}, not {len(self.robots)}")
        for number, robot in enumerate(self.robots):
            if robot in (self.robot, *self.robots[:number]):
                raise InvalidInput(f"robots: {robot.name} is there twice; name each robot once")
        if not self.gaits:
            object.__setattr__(self, "gaits", tuple(own_gait(robot) for robot in self.robots))
        if len(self.gaits) != len(self.robots):
            raise InvalidInput(
                f"gaits must be as many as robots, {len(self.robots)}, not {len(self.gaits)}; "
                "leave them out for those that suit the robots"
            )
        for robot, gait in self._walkers():
            try:
                check_reach(robot, resolve(gait, robot.azimuths_deg), self.grid)
            except Unreachable as error:
                raise Unreachable(f"{robot.name}: {error}", error.legs) from error

    def _check_worlds(self) -> None:
        if not 1 <= len(self.worlds) <= MAX_WORLDS:
            raise InvalidInput(f"worlds must be 1 to {MAX_WORLDS}, not {len(self.worlds)}")
        worlds = [lasting_world(name) for name in self.worlds]
        for number, world in enumerate(worlds):
            if world in worlds[:number]:
                raise InvalidInput(f"worlds: {self.worlds[number]} is there twice; name it once")
            for robot, _ in self._walkers():
                world.check(robot, self.simulator)

    def _walkers(self) -> Iterator[tuple[Robot, AnyGait]]:
        """Yield each robot that may walk, with its gait."""
        yield self.robot, self.gait
        yield from zip(self.robots, self.gaits, strict=True)

    def gait_of(self, robot: Robot) -> AnyGait:
        """Return the gait in which a robot walks here.

        Raises:
            InvalidInput: if the rules do not name the robot.
        """
        for allowed, gait in self._walkers():
            if allowed == robot:
                return gait
        names = ", ".join(robot.name for robot, _ in self._walkers())
        raise InvalidInput(f"{robot.name} is no robot of this tournament; choose one of: {names}")


@dataclass(frozen=True)
class Draw(Record):
    """A seed and a world on which all entries are judged, so that they can be compared in pairs.

    Attributes:
        seed: seed of practice and race.
        world: name of the world, or its disturbances.
    """

    seed: Seed
    world: str


def commitment_of(secret: str) -> str:
    """Return the commitment to a secret, published before the end: its SHA-256, hexadecimal.

    With it anyone can check after the end that the draws were fixed at the beginning.

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
