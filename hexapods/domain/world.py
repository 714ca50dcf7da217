"""Worlds: the disturbances of a walk, of the ground and of the robot.

A `World` is a frozen value. `World.as_of(step)` returns the conditions of one step: a world whose
disturbances all hold from the start, by which physics models are compiled and cached.
"""

from bisect import bisect_right
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Annotated, Any, NamedTuple, TypeVar

from hexapods.domain.disturbance_documents import (
    DISTURBANCE_SCHEMA,
    as_mapping,
    as_text,
    disturbance_from,
    parse_disturbance,
)
from hexapods.domain.disturbances import (
    Disturbance,
    Friction,
    Key,
    Limp,
    Lost,
    Patch,
    Payload,
    Push,
    Repair,
    Rough,
    SensorNoise,
    Slope,
    Stuck,
    Weak,
)
from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.records import JsonForm
from hexapods.domain.robot import Robot
from hexapods.domain.short_repr import short_repr

MAX_DISTURBANCES = 20
"""Maximum of disturbances in a request."""
MAX_IN_A_RUN = 200
"""Maximum of disturbances in a run, with those that are added while it runs."""
KINEMATIC_KINDS = (SensorNoise.kind,)
"""Kinds that the kinematic simulator simulates, which has no ground and no servos."""
D = TypeVar("D", bound=Disturbance)


def is_simulated(kind: str, simulator: str) -> bool:
    """Whether a simulator simulates a kind of disturbance."""
    return simulator != "kinematic" or kind in KINEMATIC_KINDS


@dataclass(frozen=True)
class World:
    """Disturbances of a walk. The default is flat ground and a robot as it was built.

    A later disturbance replaces an earlier one of the same part, such as a leg.

    Raises:
        InvalidInput: if two disturbances contradict each other.
    """

    __repr__ = short_repr

    disturbances: Sequence[Disturbance] = ()

    def __post_init__(self) -> None:
        disturbances: Any = self.disturbances  # not validated
        if not isinstance(disturbances, list | tuple) or not all(
            isinstance(d, Disturbance) for d in disturbances
        ):
            raise InvalidInput(
                "a World is made of disturbances, as World([Limp(legs=[1])]), not of "
                f"{disturbances!r}"
            )
        object.__setattr__(self, "disturbances", tuple(disturbances))
        for number, disturbance in enumerate(self.disturbances):
            for other in self.disturbances[:number]:
                _check_compatible(other, disturbance)
        for disturbance in self.disturbances:
            _check_possible(self, disturbance)

    def __bool__(self) -> bool:
        return bool(self.disturbances)

    def __add__(self, more: Iterable[Disturbance]) -> "World":
        return World((*self.disturbances, *more))

    def check(self, robot: Robot, simulator: str, steps: int | None = None) -> None:
        """Check that a simulator can simulate it with a robot, in a walk of so many steps.

        Raises:
            InvalidInput: if it cannot; the message names what is valid.
        """
        if len(self.disturbances) > MAX_IN_A_RUN:
            raise InvalidInput(
                f"a run has at most {MAX_IN_A_RUN} disturbances, not {len(self.disturbances)}"
            )
        for disturbance in self.disturbances:
            disturbance.check(robot)
            if not is_simulated(disturbance.kind, simulator):
                raise InvalidInput(
                    f"the kinematic simulator knows no {disturbance.kind}, only "
                    f"{', '.join(KINEMATIC_KINDS)}; choose the simulator mujoco"
                )
            if steps is not None and disturbance.at_step >= steps:
                raise InvalidInput(
                    f"{disturbance.kind}: at_step must be from 0 to {steps - 1:,}, the last step "
                    f"of this run, not {disturbance.at_step:,}"
                )

    @cached_property
    def change_steps(self) -> tuple[int, ...]:
        """The steps after the start in which conditions change, ascending."""
        ends = {
            disturbance.until_step
            for disturbance in self.disturbances
            if disturbance.until_step is not None
        }
        begins = {
            disturbance.at_step for disturbance in self.disturbances if disturbance.at_step > 0
        }
        return tuple(sorted(begins | ends))

    @cached_property
    def _conditions(self) -> tuple["World", ...]:
        """The conditions from the start, and from each of `change_steps`."""
        return tuple(self._conditions_at(step) for step in (0, *self.change_steps))

    def as_of(self, step: int) -> "World":
        """Return the conditions of a step: what holds then, leg by leg, without pushes."""
        if not self.disturbances:
            return self
        return self._conditions[bisect_right(self.change_steps, step)]

    def _conditions_at(self, step: int) -> "World":
        newest: dict[Key, Disturbance] = {}
        for disturbance in sorted(self.disturbances, key=lambda entry: entry.at_step):
            if not disturbance.holds_at(step) or not disturbance.lasts:
                continue
            for covered in [key for key in newest if _covers(disturbance, key)]:
                del newest[covered]
            for key, of_part in disturbance.parts().items():
                newest[key] = replace(of_part, at_step=0, until_step=None)
        return _conditions(entry for entry in newest.values() if not entry.repairs)

    def then(self, disturbance: Disturbance) -> "World":
        """Return the world with one more disturbance, after those that begin in the same step.

        It replaces disturbances of the same part that begin in this step, but no push.

        Raises:
            InvalidInput: if it contradicts another disturbance.
        """
        earlier: list[Disturbance] = []
        for other in self.disturbances:
            by_part = other.parts()
            may_replace = other.at_step == disturbance.at_step and disturbance.lasts
            remaining = [
                of_part
                for key, of_part in by_part.items()
                if not (may_replace and _covers(disturbance, key))
            ]
            earlier += [other] if len(remaining) == len(by_part) else remaining
        return World((*earlier, disturbance))

    @property
    def at_start(self) -> "World":
        """Disturbances that begin at the start, without their ends and without pushes."""
        at_start = (entry for entry in self.disturbances if entry.at_step == 0 and entry.lasts)
        return World(tuple(replace(entry, until_step=None) for entry in at_start))

    def later(self, steps: int) -> "World":
        """Return the world whose disturbances begin and end so many steps later."""
        return World(
            tuple(
                replace(
                    disturbance,
                    at_step=disturbance.at_step + steps,
                    until_step=None
                    if disturbance.until_step is None
                    else disturbance.until_step + steps,
                )
                for disturbance in self.disturbances
            )
        )

    def ground_m(self, step: int) -> float:
        """Return the height of the highest bumps of the ground in a step [m]."""
        if not self.disturbances:
            return 0.0
        return max((rough.amplitude_m for rough in self.as_of(step).all_of(Rough)), default=0.0)

    def pushes_at(self, step: int) -> tuple[Push, ...]:
        """Return the pushes at the beginning of a step."""
        return tuple(push for push in self.all_of(Push) if push.at_step == step)

    def all_of(self, kind: type[D]) -> tuple[D, ...]:
        """Return the disturbances of a kind."""
        return tuple(
            disturbance for disturbance in self.disturbances if isinstance(disturbance, kind)
        )

    def one_of(self, kind: type[D]) -> D | None:
        """Return the first disturbance of a kind; None without one."""
        return next(iter(self.all_of(kind)), None)


UNDISTURBED = World()


def check_ends(disturbances: Iterable[Disturbance], steps: int) -> None:
    """Check that disturbances which end do so within a run of so many steps.

    Raises:
        InvalidInput: if one ends after it.
    """
    for disturbance in disturbances:
        if disturbance.until_step is not None and disturbance.until_step > steps:
            raise InvalidInput(
                f"{disturbance.kind}: until_step must be at most {steps:,}, the end of this run, "
                f"not {disturbance.until_step:,}; leave it out for what lasts"
            )


def world(data: Iterable[Mapping[str, Any]] | World) -> World:
    """Build a world from user input, a list of disturbances.

    Raises:
        UnknownName, InvalidInput: if a disturbance is not valid, or two contradict each other.
    """
    return data if isinstance(data, World) else World(tuple(map(disturbance_from, data)))


_LIST = {"type": "array", "items": DISTURBANCE_SCHEMA}
AnyWorld = Annotated[
    World, JsonForm(world, lambda world: [as_mapping(entry) for entry in world.disturbances], _LIST)
]
"""A world as the list of its disturbances."""


def _conditions(disturbances: Iterable[Disturbance]) -> World:
    """Return a world of disturbances that were checked before, in one order."""
    conditions = object.__new__(World)
    object.__setattr__(conditions, "disturbances", tuple(sorted(disturbances, key=repr)))
    return conditions


def _covers(disturbance: Disturbance, key: Key) -> bool:
    """Whether a disturbance replaces an earlier one of this key: that of a leg, one of a joint."""
    return any(key[: len(prefix)] == prefix for prefix in disturbance.parts())


def _check_compatible(first: Disturbance, other: Disturbance) -> None:
    """Check that two disturbances of the same part do not begin in the same step.

    Raises:
        InvalidInput: if they contradict each other.
    """
    if first.at_step != other.at_step or not (first.lasts and other.lasts):
        return
    if any(_covers(first, key) for key in other.parts()) or any(
        _covers(other, key) for key in first.parts()
    ):
        raise InvalidInput(
            f"{first.kind} and {other.kind} at step {first.at_step:,} contradict each other; "
            "let one begin later, or leave one out"
        )


def _check_possible(world: World, disturbance: Disturbance) -> None:
    """Check that a disturbance is compatible with those that hold when it begins.

    Raises:
        InvalidInput: if it contradicts one of them.
    """
    if isinstance(disturbance, Push | Repair):
        return
    earlier = [
        entry
        for entry in world.disturbances
        if entry.at_step <= disturbance.at_step and entry is not disturbance
    ]
    for holding in _held_at(earlier, disturbance.at_step):
        same = any(_covers(holding, key) for key in disturbance.parts())
        is_lost = isinstance(holding, Lost) and same and not isinstance(disturbance, Lost)
        if is_lost or _is_patch_on_bumps(disturbance, holding) or _overlap(disturbance, holding):
            raise InvalidInput(
                f"{disturbance.kind} at step {disturbance.at_step:,} contradicts "
                f"{holding.kind}, which holds then; let one end before the other begins, "
                "or leave one out"
            )


def _held_at(disturbances: Iterable[Disturbance], step: int) -> tuple[Disturbance, ...]:
    """Return the newest disturbances of each part that hold in a step."""
    unchecked = object.__new__(World)
    object.__setattr__(unchecked, "disturbances", tuple(disturbances))
    return tuple(unchecked._conditions_at(step).disturbances)


def _is_patch_on_bumps(first: Disturbance, other: Disturbance) -> bool:
    """Whether one is a patch and the other rough ground: patches lie on flat ground."""
    rough = first if isinstance(first, Rough) else other
    is_rough = isinstance(rough, Rough) and rough.amplitude_m > 0
    return is_rough and (isinstance(first, Patch) or isinstance(other, Patch))


def _overlap(first: Disturbance, other: Disturbance) -> bool:
    """Whether two disturbances are different patches that overlap."""
    if (
        not isinstance(first, Patch)
        or not isinstance(other, Patch)
        or first.parts() == other.parts()
    ):
        return False
    places = (first.from_m, first.to_m), (other.from_m, other.to_m)
    return places[0] != places[1] and first.from_m < other.to_m and other.from_m < first.to_m


class NamedWorld(NamedTuple):
    """A world with a name, for users to choose.

    Attributes:
        title: its name on the page.
        help: one sentence.
        world: its disturbances, from the start.
    """

    title: str
    help: str
    world: World


WORLDS: Mapping[str, NamedWorld] = {
    "flat": NamedWorld("Flat ground", "Even ground, and the robot as it was built.", World()),
    "slope": NamedWorld(
        "Slope", "The track rises by 8°.", World((Slope(degrees=8.0),))
    ),
    "rough": NamedWorld(
        "Rough ground", "Bumps of up to 15 mm.", World((Rough(amplitude_m=0.015),))
    ),
    "ice": NamedWorld(
        "Ice", "The ground grips a tenth as well.", World((Friction(value=0.1),))
    ),
    "patch": NamedWorld(
        "Icy patch", "Ice between 0.1 and 0.25 m of the track.",
        World((Patch(from_m=0.1, to_m=0.25, friction=0.05),)),
    ),
    "payload": NamedWorld(
        "Payload", "1 kg on the right side.", World((Payload(kg=1.0, x_m=0.08),))
    ),
    "limp-pair": NamedWorld(
        "Two limp legs", "Legs 1 and 4 have no power.", World((Limp(legs=(1, 4)),))
    ),
    "stuck-leg": NamedWorld(
        "Stuck leg", "The femur of leg 2 is stuck.",
        World((Stuck(leg=2, joint="femur", angle_rad=-0.9),)),
    ),
    "lost-leg": NamedWorld("Lost leg", "Leg 2 is gone.", World((Lost(legs=(2,)),))),
    "weak": NamedWorld(
        "Weak legs",
        "Legs 1 to 4 have a third of their torque.",
        World((Weak(legs=(1, 2, 3, 4), torque_share=0.33),)),
    ),
    "noise": NamedWorld(
        "Sensor noise", "Feet are measured 4 mm wrong.", World((SensorNoise(sd_m=0.004),))
    ),
}  # fmt: skip


def world_from(name: str | None, more: Iterable[Disturbance]) -> World:
    """Return the world of a name, or an undisturbed one, with further disturbances.

    Raises:
        UnknownName: if there is no world of this name.
        InvalidInput: if two disturbances contradict each other.
    """
    return (UNDISTURBED if name is None else named_world(name)) + more


def named_world(name: str) -> World:
    """Return a world by its name.

    Raises:
        UnknownName: if there is none of this name.
    """
    if name not in WORLDS:
        raise UnknownName("world", name, WORLDS)
    return WORLDS[name].world


def parse_world(text: str) -> World:
    """Parse a world: a name, or disturbances joined by +, such as `limp:legs=1,4+slope:degrees=4`.

    Raises:
        UnknownName, InvalidInput: if it is neither.
    """
    if text in WORLDS or ":" not in text:
        return named_world(text)
    return World(tuple(parse_disturbance(disturbance) for disturbance in text.split("+")))


def world_text(world: World) -> str:
    """Return a world as `parse_world` reads it: `flat`, a name, or disturbances joined by +."""
    named = (name for name, named_world in WORLDS.items() if named_world.world == world)
    return next(named, "+".join(map(as_text, world.disturbances)))


def lasting_world(text: str) -> World:
    """Parse a world whose disturbances hold from the start to the end.

    Raises:
        UnknownName, InvalidInput: as `parse_world`, or if something begins later or ends.
    """
    parsed = parse_world(text)
    if parsed.change_steps:
        raise InvalidInput(
            f"{text}: the worlds of an experiment or a tournament hold from the start to the end; "
            "leave out at and until"
        )
    return parsed
