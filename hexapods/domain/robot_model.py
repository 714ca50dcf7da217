"""The model of a robot that was read from a file: its links, joints and feet, in plain numbers.

The body frame is that of every robot here: x right, y forward, z up, its origin at the torso's
centre. Links are a tree below the torso, whose joints are only those of legs: what else could move
in the file, such as an arm or a wheel, was fixed when it was read. Nothing here is text that
another program parses, so that a model from a stranger's archive is as harmless as its numbers.
"""

import hashlib
import math
import re
from base64 import b64decode, b64encode
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from hexapods.domain.body import MAX_LEGS, MIN_LEGS
from hexapods.domain.errors import InvalidInput
from hexapods.domain.records import Record

GeomKind = Literal["sphere", "capsule", "cylinder", "ellipsoid", "box"]
Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
MIN_JOINTS, MAX_JOINTS = 2, 6
"""Joints of a leg."""
MAX_LINKS = 200
MAX_GEOMS = 1000
"""Maximum of geoms of all links together."""
MAX_TRIANGLES = 60_000
"""Maximum of triangles of all meshes together."""
JOINT_NAME = re.compile(r"[A-Za-z0-9_.-]{1,40}", re.ASCII)
MAX_SIZE_M = 10.0
"""Largest coordinate of a mesh, and largest size of a geom."""
MAX_ANGLE_RAD = 7.0
"""Largest limit of a joint, more than a turn."""
_UNIT = 1e-6
"""How far the length of an axis or a quaternion may be from 1."""


@dataclass(frozen=True)
class ModelGeom(Record):
    """A simple shape on a link, which touches the ground.

    Attributes:
        kind: as MuJoCo calls it.
        size_m: as in MuJoCo: a radius; a radius and half a length along z; or half sides.
            Numbers that the kind does not need are 0.
        at_m: its centre in the frame of its link.
        wxyz: its rotation in the frame of its link.
    """

    kind: GeomKind
    size_m: Vector
    at_m: Vector
    wxyz: Quaternion


@dataclass(frozen=True)
class ModelMesh(Record):
    """Drawn shape of a link.

    Attributes:
        vertices: coordinates in the frame of the link [m], float32, little-endian, (n, 3), in
            base64.
        faces: the vertices of each triangle, uint32, little-endian, (m, 3), in base64.
        triangles: m.
    """

    vertices: str
    faces: str
    triangles: int

    @classmethod
    def of(cls, vertices: NDArray[Any], faces: NDArray[Any]) -> "ModelMesh":
        """Return the mesh of vertices (n, 3) [m] and faces (m, 3)."""
        floats, corners = vertices.astype("<f4"), faces.astype("<u4")
        return cls(_base64(floats), _base64(corners), len(corners))

    def arrays(self) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
        """Return vertices (n, 3) [m] and faces (m, 3).

        Raises:
            InvalidInput: if they are not valid arrays of that number of triangles.
        """
        try:
            vertices = np.frombuffer(b64decode(self.vertices, validate=True), "<f4").reshape(-1, 3)
            faces = np.frombuffer(b64decode(self.faces, validate=True), "<u4").reshape(-1, 3)
        except ValueError as error:
            raise InvalidInput(f"a mesh is damaged: {error}") from error
        fits = len(faces) == self.triangles and (not len(faces) or faces.max() < len(vertices))
        if not (fits and np.isfinite(vertices).all()):
            raise InvalidInput("a mesh is damaged: its faces do not fit its vertices")
        return vertices, faces


@dataclass(frozen=True)
class ModelJoint(Record):
    """A hinge by which a link turns against its parent, and the servo that turns it.

    Attributes:
        name: a `JOINT_NAME`; no other joint of its leg has it; the links of all legs have names of
            one kind, such as `hip` or `knee`, where the file has.
        axis: unit vector in the frame of the link.
        anchor_m: a point of the axis in the frame of the link.
        limits_rad: lowest and highest angle.
        home_rad: the angle with which the robot stands.
        servo_kp: position gain [N·m/rad].
        servo_kv: velocity gain [N·m·s/rad].
        servo_torque_nm: the largest torque.
        armature: rotor inertia reflected to the joint [kg·m²].
        damping: [N·m·s/rad].
        friction_nm: dry friction, which the servo must overcome to turn the joint.
    """

    name: str
    axis: Vector
    anchor_m: Vector
    limits_rad: tuple[float, float]
    home_rad: float
    servo_kp: float
    servo_kv: float
    servo_torque_nm: float
    armature: float
    damping: float
    friction_nm: float = 0.0


@dataclass(frozen=True)
class ModelLink(Record):
    """A rigid body. With all joints at the angle 0 its frame is as `at_m` and `wxyz` say.

    Attributes:
        name: its name in the file, or a number.
        parent: index of its parent among the links, which comes before it; −1 for the torso.
        leg: number of its leg, from 1; 0 for the torso and what is fixed to it.
        at_m: origin of its frame in that of its parent; (0, 0, 0) for the torso.
        wxyz: rotation of its frame against that of its parent.
        mass_kg: its mass; at least 1e-6.
        center_m: its centre of mass in its frame.
        inertia: about the centre of mass along the axes of its frame [kg·m²]: xx, yy, zz, xy, xz,
            yz.
        joint: the hinge by which it turns; None if it is fixed to its parent.
        geoms: shapes that touch the ground.
        mesh: drawn shape; None to draw its geoms.
    """

    name: str
    parent: int
    leg: int
    at_m: Vector
    wxyz: Quaternion
    mass_kg: float
    center_m: Vector
    inertia: tuple[float, float, float, float, float, float]
    joint: ModelJoint | None = None
    geoms: tuple[ModelGeom, ...] = ()
    mesh: ModelMesh | None = None


@dataclass(frozen=True)
class ModelFoot(Record):
    """The foot of a leg: a sphere.

    Attributes:
        link: index of the link that has it.
        at_m: its centre in the frame of the link.
        radius_m: its radius.
    """

    link: int
    at_m: Vector
    radius_m: float


@dataclass(frozen=True, eq=False, repr=False)
class RobotModel(Record):
    """A robot from a file.

    Legs are numbered anticlockwise from the front right one, seen from above, as everywhere; the
    links of a leg are in a row, from the torso outward.

    Attributes:
        links: the torso, then the links of each leg.
        feet: the foot of each leg.

    Raises:
        InvalidInput: unless it has 3 to 12 legs of 2 to 6 joints each, all of which move their
            foot.
    """

    links: tuple[ModelLink, ...]
    feet: tuple[ModelFoot, ...]

    def __post_init__(self) -> None:
        for problem in self._problems():
            raise InvalidInput(f"the model of the robot is damaged: {problem}")

    @cached_property
    def digest(self) -> str:
        """SHA-256 of its content, by which models are compared."""
        return hashlib.sha256(repr(_content(self)).encode()).hexdigest()

    def __repr__(self) -> str:
        return f"RobotModel({len(self.links)} links, {len(self.feet)} legs, {self.digest[:8]})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, RobotModel) and self.digest == other.digest

    def __hash__(self) -> int:
        return hash(self.digest)

    def links_of(self, leg: int) -> list[ModelLink]:
        """Return the links of a leg, counted from 1; for 0 the torso and links fixed to it."""
        return [link for link in self.links if link.leg == leg]

    def joints_of(self, leg: int) -> list[ModelJoint]:
        """Return the joints of a leg, counted from 1, from the torso to the foot."""
        return [link.joint for link in self.links_of(leg) if link.joint is not None]

    def _problems(self) -> Iterator[str]:
        yield from self._problems_of_size()
        for number, link in enumerate(self.links):
            for problem in (*self._problems_of_place(number, link), *_problems_of_link(link)):
                yield f"link {number} ({link.name}) {problem}"
        if [link.leg for link in self.links] != sorted(link.leg for link in self.links):
            yield "its links must be leg by leg, after the torso"
        for leg, foot in enumerate(self.feet, start=1):
            yield from self._problems_of_leg(leg, foot)

    def _problems_of_size(self) -> Iterator[str]:
        legs = len(self.feet)
        if not 0 < len(self.links) <= MAX_LINKS:
            yield f"it must have 1 to {MAX_LINKS} links, not {len(self.links)}"
        if not MIN_LEGS <= legs <= MAX_LEGS:
            yield f"it must have {MIN_LEGS} to {MAX_LEGS} legs, not {legs}"
        if sum(len(link.geoms) for link in self.links) > MAX_GEOMS:
            yield f"it must have at most {MAX_GEOMS} geoms"
        triangles = sum(link.mesh.triangles for link in self.links if link.mesh)
        if triangles > MAX_TRIANGLES:
            yield f"its meshes must have at most {MAX_TRIANGLES} triangles"

    def _problems_of_place(self, number: int, link: ModelLink) -> Iterator[str]:
        if not (-1 if number == 0 else 0) <= link.parent < number:
            yield "has no parent before it"
        elif number == 0 and (link.joint or link.leg):
            yield "must be the torso, without a joint"
        elif number and self.links[link.parent].leg not in (0, link.leg):
            yield "has a parent in another leg"
        if not 0 <= link.leg <= len(self.feet) or (link.joint is not None and link.leg == 0):
            yield "is of no leg"

    def _problems_of_leg(self, leg: int, foot: ModelFoot) -> Iterator[str]:
        if not (0 < foot.link < len(self.links) and self.links[foot.link].leg == leg):
            yield f"the foot of leg {leg} is on no link of it"
            return
        if not (_are_finite(foot.at_m) and 0.001 <= foot.radius_m <= 2):
            yield f"the foot of leg {leg} must have a radius of 0.001 to 2 m"
        names = [joint.name for joint in self.joints_of(leg)]
        if not MIN_JOINTS <= len(names) <= MAX_JOINTS or len(set(names)) < len(names):
            yield f"leg {leg} must have {MIN_JOINTS} to {MAX_JOINTS} joints with own names"
        carrying, link = set(), self.links[foot.link]
        while link.leg:
            carrying.add(link.joint.name if link.joint else "")
            link = self.links[link.parent]
        if still := [name for name in names if name not in carrying]:
            yield f"joint {still[0]} of leg {leg} does not move its foot"


def _base64(array: NDArray[Any]) -> str:
    return b64encode(array.tobytes()).decode("ascii")


def _content(value: Any) -> Any:
    """Return a model in tuples; whole numbers are floats, as they are when a file is read."""
    if isinstance(value, Record):
        return tuple(_content(item) for name, item in vars(value).items() if name != "digest")
    if isinstance(value, tuple):
        return tuple(map(_content, value))
    return float(value) if isinstance(value, int | float) else value


def _problems_of_link(link: ModelLink) -> Iterator[str]:
    if not (1e-6 <= link.mass_kg <= 1000 and _are_finite((*link.center_m, *link.inertia))):
        yield "must have a mass of 1e-6 to 1000 kg"
    if not (_are_finite(link.at_m) and _is_unit(link.wxyz)):
        yield "has no place"
    if link.joint is not None:
        yield from _problems_of_joint(link.joint)
    for geom in link.geoms:
        if not (_are_finite((*geom.at_m, *geom.size_m)) and _is_unit(geom.wxyz)):
            yield "has a geom without a place"
        if min(geom.size_m) < 0 or not 0 < max(geom.size_m) <= MAX_SIZE_M:
            yield f"has a geom without a size, or larger than {MAX_SIZE_M:g} m"
    if link.mesh is not None:
        yield from _problems_of_mesh(link.mesh)


def _problems_of_mesh(mesh: ModelMesh) -> Iterator[str]:
    try:
        vertices, _ = mesh.arrays()
    except InvalidInput as error:
        yield f"has none that can be drawn: {error}"
    else:
        if len(vertices) and float(np.abs(vertices).max()) > MAX_SIZE_M:
            yield f"has a mesh larger than {MAX_SIZE_M:g} m"


def _problems_of_joint(joint: ModelJoint) -> Iterator[str]:
    low, high = joint.limits_rad
    if JOINT_NAME.fullmatch(joint.name) is None:
        yield (
            f"has a joint {joint.name[:40]!r}: names have 1 to 40 letters, digits, points, "
            "hyphens and underscores"
        )
    if not (-MAX_ANGLE_RAD <= low < high <= MAX_ANGLE_RAD and low <= joint.home_rad <= high):
        yield f"has a joint {joint.name} that is not at home within its limits"
    if not (_is_unit(joint.axis) and _are_finite(joint.anchor_m)):
        yield f"has a joint {joint.name} without an axis"
    numbers = joint.servo_kp, joint.servo_kv, joint.servo_torque_nm, joint.armature
    losses = joint.damping, joint.friction_nm
    if not (_are_finite((*numbers, *losses)) and min(numbers) > 0 <= min(losses)):
        yield f"has a joint {joint.name} whose servo has no strength"


def _are_finite(numbers: tuple[float, ...]) -> bool:
    return all(math.isfinite(number) and abs(number) <= 1e6 for number in numbers)


def _is_unit(numbers: tuple[float, ...]) -> bool:
    return _are_finite(numbers) and abs(math.hypot(*numbers) - 1) <= _UNIT
