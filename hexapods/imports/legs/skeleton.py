"""Finds in a compiled model the torso, the legs and their feet; all other joints are locked.

A leg is a chain of hinges from the torso to a foot. Joints that two legs share, such as a spine,
and those of no leg, such as an arm's, are locked.
"""

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from hexapods.domain.body import MAX_LEGS, MIN_LEGS
from hexapods.domain.errors import InvalidInput
from hexapods.domain.robot_model import MAX_JOINTS, MIN_JOINTS
from hexapods.domain.text import counted
from hexapods.domain.types import FloatArray
from hexapods.imports.choices import Choices
from hexapods.imports.compiling import Compiled
from hexapods.imports.legs.closed_loops import second_chains
from hexapods.imports.legs.feet import FoundLeg, chosen_foot, find_foot
from hexapods.imports.notes import Notes, listed, quoted

_NO_LEG = re.compile(
    r"\b(arm|gripper|fingers?|head|neck|tail|wrist|camera|lidar|hand|jaw|antenna|ear|wings?"
    r"|abdomen|haltere|proboscis|rostrum)\b"
)
"""Words in names of what is no leg."""
_WHEEL = re.compile(r"wheel", re.IGNORECASE)
_SAME_HEIGHT = 0.3
"""Ends are as low as the lowest within this share of the longest chain."""
_SHARED_JOINTS = 2
"""Ends that share so many joints are of one leg."""
_ENOUGH_JOINTS = 3
"""A leg with a wheel has more."""
_HINGE = int(mujoco.mjtJoint.mjJNT_HINGE)


@dataclass(frozen=True)
class Skeleton:
    """The torso and the legs of a model.

    Attributes:
        root: the body of which all are descendants.
        bodies: ids of the robot's bodies.
        legs: in no order.
        locked: ids of hinges, slides and balls that do not move.
        feet: names of what could be feet.
        hidden: ids of bodies that are not drawn, since they would stand still.
    """

    root: int
    bodies: tuple[int, ...]
    legs: tuple[FoundLeg, ...]
    locked: tuple[int, ...]
    feet: tuple[str, ...]
    hidden: frozenset[int]


def find_skeleton(compiled: Compiled, pose: FloatArray, choices: Choices, notes: Notes) -> Skeleton:
    """Find torso, legs and feet.

    Args:
        compiled: the model.
        pose: `qpos` at which the ends of chains are compared.
        choices: what a person decided.
        notes: gets what is guessed.

    Raises:
        InvalidInput: if there are not 3 to 12 legs of 2 to 6 joints.
    """
    return _Finder(compiled, pose, choices, notes).find()


class _Finder:
    def __init__(
        self, compiled: Compiled, pose: FloatArray, choices: Choices, notes: Notes
    ) -> None:
        self._compiled, self._choices, self._notes = compiled, choices, notes
        self._model = compiled.model
        self._parent: list[int] = self._model.body_parentid.tolist()
        self._data = mujoco.MjData(self._model)
        self._data.qpos[:] = pose
        mujoco.mj_kinematics(self._model, self._data)
        joints_of: dict[int, list[int]] = {}
        for joint, body in enumerate(self._model.jnt_bodyid.tolist()):
            joints_of.setdefault(body, []).append(joint)
        self._joints_of: Mapping[int, Sequence[int]] = joints_of
        self._second_joints: frozenset[int] = frozenset()
        """Joints of chains of closed loops, each of which ends at the foot of a leg."""

    def find(self) -> Skeleton:
        root = self._root()
        bodies = tuple(self._below(root))
        moving = [joint for body in bodies if body != root for joint in self._hinges(body)]
        wheels = self._wheels(moving, bodies, root)
        hinges = [joint for joint in moving if joint not in wheels]
        ends = {body: self._chain(body, root, hinges) for body in self._ends(bodies, hinges, root)}
        if self._choices.feet is not None:
            legs = [self._chosen(name, root, bodies, hinges) for name in self._choices.feet]
        else:
            legs = self._lowest_chains(ends, hinges, wheels)
        legs = self._without_shared(legs)
        used = {joint for leg in legs for joint in leg.joints}
        self._tell_of_base(root)
        locked = tuple(
            joint
            for body in bodies
            if body != root
            for joint in self._joints_of.get(body, ())
            if joint not in used
        )
        self._tell_of_locked(locked, wheels)
        feet = self._possible_feet(ends, hinges, wheels)
        hidden = self._below_joints(self._second_joints, bodies)
        return Skeleton(root, bodies, tuple(legs), locked, feet, hidden)

    def _root(self) -> int:
        """Return the child of the world whose descendants have the most hinges."""
        roots = [body for body, parent in enumerate(self._parent) if body and parent == 0]

        def hinges(root: int) -> int:
            return sum(len(self._hinges(body)) for body in self._below(root) if body != root)

        best = max(roots, key=hinges, default=0)
        if not best or not hinges(best):
            raise InvalidInput(
                f"it has no legs: no body has hinges below it; a robot has {MIN_LEGS} to "
                f"{MAX_LEGS} legs of {MIN_JOINTS} to {MAX_JOINTS} hinges each"
            )
        other_roots = [body for body in roots if body != best]
        if other_roots:
            names = [self._compiled.body_name(body) for body in other_roots]
            self._notes.repair(
                "links", f"left out what is not joined to the robot: {listed(names)}", names
            )
        return best

    def _below(self, root: int) -> Iterator[int]:
        """Iterate over a body and its descendants; parents come first, as in MuJoCo."""
        inside = {root}
        yield root
        for body in range(root + 1, len(self._parent)):
            if self._parent[body] in inside:
                inside.add(body)
                yield body

    def _hinges(self, body: int) -> list[int]:
        joints = self._joints_of.get(body, ())
        return [joint for joint in joints if int(self._model.jnt_type[joint]) == _HINGE]

    def _chain(self, body: int, root: int, hinges: Sequence[int]) -> list[int]:
        """Return the hinges from the torso to a body."""
        chain: list[int] = []
        while body not in (0, root):
            chain[:0] = [joint for joint in self._joints_of.get(body, ()) if joint in hinges]
            body = self._parent[body]
        return chain

    def _ends(self, bodies: Sequence[int], hinges: Sequence[int], root: int) -> list[int]:
        """Return the bodies with hinges that have no others with hinges below them."""
        with_hinges = {int(self._model.jnt_bodyid[joint]) for joint in hinges}
        inner: set[int] = set()
        for body in with_hinges:
            above = self._parent[body]
            while above not in (0, root):
                inner.add(above)
                above = self._parent[above]
        return [body for body in bodies if body in with_hinges and body not in inner]

    def _rigid(self, body: int, hinges: Sequence[int]) -> list[int]:
        """Return the bodies that move with one, with those that are fixed or locked to it."""
        rigid = [body]
        for other in range(body + 1, len(self._parent)):
            moves = any(joint in hinges for joint in self._joints_of.get(other, ()))
            if self._parent[other] in rigid and not moves:
                rigid.append(other)
        return rigid

    def _wheels(self, hinges: Sequence[int], bodies: Sequence[int], root: int) -> set[int]:
        """Return the last joints of chains that turn without end and are wheels.

        They are called so, or the leg has enough joints without them, which have limits.
        """
        wheels = set()
        for body in self._ends(bodies, hinges, root):
            chain = self._chain(body, root, hinges)
            joint = chain[-1]
            names = self._compiled.joint_name(joint), self._compiled.body_name(body)
            has_others = any(self._model.jnt_limited[other] for other in chain[:-1])
            is_spare = len(chain) > _ENOUGH_JOINTS and has_others
            if not self._model.jnt_limited[joint] and (is_spare or any(map(_WHEEL.search, names))):
                wheels.add(joint)
        return wheels

    def _lowest_chains(
        self,
        ends: Mapping[int, Sequence[int]],
        hinges: Sequence[int],
        wheels: set[int],
    ) -> list[FoundLeg]:
        """Return the chains whose ends reach lowest."""
        chains = []
        for body, chain in ends.items():
            if len(chain) >= MIN_JOINTS:
                foot = find_foot(
                    self._compiled, self._data, self._rigid(body, hinges), chain[-1], wheels
                )
                chains.append(FoundLeg(tuple(chain), foot))
        named_so = [leg for leg in chains if self._is_no_leg(leg)]
        if len(chains) - len(named_so) >= MIN_LEGS:
            chains = [leg for leg in chains if leg not in named_so]
        chains.sort(key=self._bottom)
        legs: list[FoundLeg] = []
        for leg in chains:
            shared = max((_shared(leg, other) for other in legs), default=0)
            if shared < _SHARED_JOINTS:
                legs.append(leg)
        if legs:
            lowest, longest = self._bottom(legs[0]), max(map(self._length, legs))
            legs = [leg for leg in legs if self._bottom(leg) <= lowest + _SAME_HEIGHT * longest]
        legs = self._without_second_chains(legs)
        if not MIN_LEGS <= len(legs) <= MAX_LEGS:
            seen = [quoted(leg.foot.name) for leg in legs]
            raise InvalidInput(
                f"found {counted(len(legs), 'leg')}"
                f"{f' (to {listed(seen)})' if seen else ''}; a robot has {MIN_LEGS} to {MAX_LEGS} "
                f"legs, each a chain of {MIN_JOINTS} to {MAX_JOINTS} hinges from the torso to a "
                "foot; name the feet if there are others"
            )
        names = listed(sorted(leg.foot.name for leg in legs))
        self._notes.guess(
            "legs",
            f"its {len(legs)} legs are the chains that reach lowest, to: {names}",
            self._bodies_of_feet(legs),
        )
        return legs

    def _without_second_chains(self, legs: list[FoundLeg]) -> list[FoundLeg]:
        """Leave out of each closed loop the second chain to its foot."""
        second = second_chains(legs, self._data)
        if second:
            names = [leg.foot.name for leg in second]
            self._notes.guess(
                "legs",
                "two chains end at each foot, closed loops that the file leaves open: they are one "
                f"leg, and the chains to {listed(sorted(names))} are not simulated, but what they "
                "weigh is at the torso",
                self._bodies_of_feet(second),
                Choices(feet=tuple(leg.foot.name for leg in legs)),
            )
            self._second_joints = frozenset(joint for leg in second for joint in leg.joints)
        return [leg for leg in legs if leg not in second]

    def _bodies_of_feet(self, legs: Iterable[FoundLeg]) -> list[str]:
        return [self._compiled.body_name(leg.foot.body) for leg in legs]

    def _below_joints(self, joints: Collection[int], bodies: Sequence[int]) -> frozenset[int]:
        """Return the bodies that some joints move."""
        moved: set[int] = set()
        for body in bodies:  # parents come first
            if self._parent[body] in moved or any(
                joint in joints for joint in self._joints_of.get(body, ())
            ):
                moved.add(body)
        return frozenset(moved)

    def _is_no_leg(self, leg: FoundLeg) -> bool:
        bodies = [int(self._model.jnt_bodyid[joint]) for joint in leg.joints]
        names = [self._compiled.joint_name(joint) for joint in leg.joints]
        names += [self._compiled.body_name(body) for body in bodies]
        return any(_NO_LEG.search(re.sub(r"[^a-z]+", " ", name.lower())) for name in names)

    def _bottom(self, leg: FoundLeg) -> float:
        return float(leg.foot.in_world(self._data)[2] - leg.foot.radius_m)

    def _length(self, leg: FoundLeg) -> float:
        start = self._data.xanchor[leg.joints[0]]
        return float(np.linalg.norm(leg.foot.in_world(self._data) - start))

    def _chosen(
        self, name: str, root: int, bodies: Sequence[int], hinges: Sequence[int]
    ) -> FoundLeg:
        """Return the leg whose foot a person named."""
        foot = chosen_foot(self._compiled, self._data, name, bodies, hinges)
        if foot is None:
            ends = self._ends(bodies, hinges, root)
            names = [self._compiled.body_name(body) for body in ends]
            raise InvalidInput(
                f"the file has no body, geom or site {quoted(name)!r} for a foot; legs end at: "
                f"{listed(names)}"
            )
        chain = self._chain(foot.body, root, hinges)
        if len(chain) < MIN_JOINTS:
            raise InvalidInput(
                f"{quoted(name)} cannot be a foot: between it and the torso are "
                f"{counted(len(chain), 'hinge')}, a leg has {MIN_JOINTS} to {MAX_JOINTS}"
            )
        return FoundLeg(tuple(chain), foot)

    def _without_shared(self, legs: Sequence[FoundLeg]) -> list[FoundLeg]:
        """Take away joints that legs share, and of longer legs those nearest to the torso."""
        counts: dict[int, int] = {}
        for leg in legs:
            for joint in leg.joints:
                counts[joint] = counts.get(joint, 0) + 1
        shortened = []
        for leg in legs:
            joints = [joint for joint in leg.joints if counts[joint] == 1][-MAX_JOINTS:]
            if len(joints) < MIN_JOINTS:
                raise InvalidInput(
                    f"the leg to {quoted(leg.foot.name)} has {counted(len(joints), 'hinge')} of its"
                    f" own; a leg has {MIN_JOINTS} to {MAX_JOINTS}"
                )
            shortened.append(FoundLeg(tuple(joints), leg.foot))
        return shortened

    def _possible_feet(
        self,
        ends: Mapping[int, Sequence[int]],
        hinges: Sequence[int],
        wheels: set[int],
    ) -> tuple[str, ...]:
        names = []
        for body, chain in ends.items():
            if len(chain) >= MIN_JOINTS:
                rigid = self._rigid(body, hinges)
                names.append(find_foot(self._compiled, self._data, rigid, chain[-1], wheels).name)
        return tuple(sorted(set(names)))

    def _tell_of_base(self, root: int) -> None:
        joints = self._joints_of.get(root, ())
        kinds = [int(self._model.jnt_type[joint]) for joint in joints]
        name = self._compiled.body_name(root)
        if kinds == [int(mujoco.mjtJoint.mjJNT_FREE)]:
            return
        moved = f"moved by {counted(len(joints), 'joint')}" if joints else "was fixed to the world"
        self._notes.repair("base", f"{quoted(name)} {moved}; now it is free", [name])

    def _tell_of_locked(self, locked: Sequence[int], wheels: set[int]) -> None:
        for which, what in (
            ([joint for joint in locked if joint in wheels], "wheels, which were locked"),
            (
                [joint for joint in locked if joint not in {*wheels, *self._second_joints}],
                "joints of no leg, which hold",
            ),
        ):
            if which:
                names = [self._compiled.joint_name(joint) for joint in which]
                self._notes.repair("joints", f"it has {what}: {listed(names)}", names)


def _shared(leg: FoundLeg, other: FoundLeg) -> int:
    return len(set(leg.joints) & set(other.joints))
