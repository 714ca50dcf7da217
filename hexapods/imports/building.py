"""Build a `RobotModel` from a compiled file: find its parts, and assemble them."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from hexapods.domain.robot_model import (
    ModelFoot,
    ModelGeom,
    ModelJoint,
    ModelLink,
    ModelMesh,
    RobotModel,
)
from hexapods.domain.sums import ordered_sum
from hexapods.domain.types import FloatArray
from hexapods.imports.choices import Choices
from hexapods.imports.compiling import Compiled
from hexapods.imports.drawing import find_meshes
from hexapods.imports.exported_pose import FOREIGN, ExportedPose
from hexapods.imports.imported import FileFormat, ImportedLeg, ImportedRobot
from hexapods.imports.legs.balance import tell_of_balance
from hexapods.imports.legs.chain import LegChain
from hexapods.imports.legs.directions import find_forward, find_gait, numbered
from hexapods.imports.legs.feet import FoundLeg
from hexapods.imports.legs.heights import body_height_m
from hexapods.imports.legs.joint_kinds import joint_kinds
from hexapods.imports.legs.stance import (
    Angles,
    RobotWithLegs,
    find_stance,
    tell_of_reach,
)
from hexapods.imports.link_limits import checked_model
from hexapods.imports.masses import Mass, find_masses, mass_in_file_kg, mass_of
from hexapods.imports.notes import Notes, quoted
from hexapods.imports.posed_robot import PosedRobot, initial_pose, keyframes_of
from hexapods.imports.servos import (
    FoundServo,
    angle_limits,
    find_servos,
    guessed_torque,
    limits_around,
)
from hexapods.imports.shapes import GroundShape, drop_touching, link_shapes, torso_shapes
from hexapods.imports.size import check_legs, check_mass, tell_of_size
from hexapods.imports.units import read_limits
from hexapods.imports.upright import find_upright

_UNLIMITED = (-np.pi, np.pi)
_GIVEN_SHARE = 0.5
"""Share of its mass that the file gives at least if its size is compared with its mass."""
_SAME_PLACE_M = 1e-3


@dataclass(frozen=True)
class FileOrigin:
    """Origin of an imported robot: its name, and the file that it was read from.

    Attributes:
        name: name of the robot.
        file_format: format of the file.
        file: path in the zip; None if it was given alone.
    """

    name: str
    file_format: FileFormat
    file: str | None


def build(
    compiled: Compiled,
    origin: FileOrigin,
    choices: Choices,
    notes: Notes,
    exported: ExportedPose = FOREIGN,
) -> ImportedRobot:
    """Build the robot from a compiled file.

    Args:
        compiled: the model.
        origin: where it is from.
        choices: what a person decided.
        notes: gets what is guessed and repaired.
        exported: what a file that was exported here says of its frame and stance.

    Raises:
        InvalidInput: if the file is no robot with legs, or a choice is not possible.
    """
    read_limits(compiled.joint_name, compiled.model, choices, notes)
    skeleton, up = find_upright(compiled, choices, notes)
    posed = PosedRobot(
        compiled, skeleton, initial_pose(compiled.model), keeps_frame=exported.keeps_frame
    )
    names = [_names_of(compiled, leg) for leg in posed.legs]
    posed.turn(find_forward(posed.mounts()[:, :2], names, up, choices, notes))
    posed.order(range(len(posed.legs)) if exported.keeps_frame else numbered(_places(posed)))
    keyframes = {**keyframes_of(compiled.model), **exported.keyframes(compiled.model)}
    return _Builder(posed, keyframes, origin, choices, notes, exported).build()


def _names_of(compiled: Compiled, leg: FoundLeg) -> list[str]:
    """Return the names of a leg's joints and foot, and of all bodies up to the torso."""
    bodies = []
    body = leg.foot.body
    while int(compiled.model.body_parentid[body]) != 0:
        bodies.append(compiled.body_name(body))
        body = int(compiled.model.body_parentid[body])
    joints = [compiled.joint_name(joint) for joint in leg.joints]
    return [*joints, *bodies, leg.foot.name]


def _places(posed: PosedRobot) -> FloatArray:
    """Return the places of the legs around the body, (legs, 2) [m]: their mounts, or their feet.

    The feet are taken where two mounts coincide, or one is at the centre.
    """
    mounts = posed.mounts()[:, :2]
    apart = np.linalg.norm(mounts[:, None] - mounts[None], axis=2)
    is_alone = (apart < _SAME_PLACE_M).sum() == len(mounts)
    if is_alone and (np.linalg.norm(mounts, axis=1) > _SAME_PLACE_M).all():
        return mounts
    return np.array([posed.foot(leg)[:2] for leg in posed.legs])


class _Builder:
    def __init__(  # noqa: PLR0917 - it only collects what `build` found
        self,
        posed: PosedRobot,
        keyframes: Mapping[str, FloatArray],
        origin: FileOrigin,
        choices: Choices,
        notes: Notes,
        exported: ExportedPose,
    ) -> None:
        self._exported = exported
        self._posed, self._origin, self._choices, self._notes = posed, origin, choices, notes
        self._compiled = posed.compiled
        self._keyframes = keyframes
        self._joints = [joint for leg in posed.legs for joint in leg.joints]
        self._limits = {joint: angle_limits(self._compiled, joint) for joint in self._joints}
        self._chains = [self._chain(leg) for leg in posed.legs]
        self._torso = torso_shapes(posed, self._span())

    def build(self) -> ImportedRobot:
        check_legs(self._chains, [leg.foot for leg in self._posed.legs])
        robot = self._robot_with_legs()
        home, heights = find_stance(robot, self._choices, self._notes)
        reaches = tell_of_reach(robot, home, self._notes)
        self._tell_of_limits()
        links: dict[int | None, str] = {None: self._name_of_torso()}
        links |= {joint: self._name_of_link(joint) for joint in self._joints}
        masses = find_masses(
            self._posed,
            links,
            self._ends(),
            self._choices,
            self._notes,
            are_whole=self._exported.keeps_frame,
        )
        mass_kg = ordered_sum(mass.kg for mass in masses.values())
        height_m = body_height_m(self._chains, home)
        if self._choices.mass_kg is None:
            given_kg = mass_in_file_kg(self._posed)
            if given_kg > _GIVEN_SHARE * mass_kg:
                tell_of_size(given_kg, robot.length_m, height_m, self._notes)
        check_mass(mass_kg)
        guess_nm = guessed_torque(mass_kg, robot.length_m, len(self._chains))
        servos = find_servos(self._compiled, self._joints, guess_nm, self._choices, self._notes)
        origins: dict[int | None, FloatArray] = {None: np.zeros(3)}
        origins |= {joint: self._posed.anchor(joint) for joint in self._joints}
        meshes = find_meshes(self._posed, origins, self._notes)
        model = self._model(links, masses, servos, meshes, home)
        gait = find_gait(self._posed.mounts()[:, :2], self._choices, self._notes)
        tell_of_balance(model, gait, heights, self._notes)
        return ImportedRobot(
            model=model,
            name=self._origin.name,
            file_format=self._origin.file_format,
            file=self._origin.file,
            legs=tuple(
                ImportedLeg(
                    tuple(self._compiled.joint_name(joint) for joint in leg.joints), leg.foot.name
                )
                for leg in self._posed.legs
            ),
            feet=self._posed.skeleton.feet,
            keyframes=tuple(self._keyframes),
            gait=gait,
            forward_deg=self._posed.turn_deg,
            mass_kg=mass_kg,
            body_height_m=height_m,
            body_heights_m=heights and (heights.lowest, heights.highest),
            reaches_grid=reaches,
            notes=self._notes.collected(),
        )

    def _chain(self, leg: FoundLeg) -> LegChain:
        limits = [self._limits[joint] or _UNLIMITED for joint in leg.joints]
        return LegChain(
            np.array([self._posed.axis(joint) for joint in leg.joints]),
            np.array([self._posed.anchor(joint) for joint in leg.joints]),
            self._posed.foot(leg),
            np.array(limits).T,
        )

    def _span(self) -> FloatArray:
        """Return half sides of a box within the mounts."""
        mounts = self._posed.mounts()
        half = (mounts.max(axis=0) - mounts.min(axis=0)) / 2
        thick = 0.1 * float(np.mean([chain.length_m for chain in self._chains]))
        span: FloatArray = np.maximum(half, thick)
        return span

    def _robot_with_legs(self) -> RobotWithLegs:
        model = self._compiled.model

        def angles(qpos: FloatArray) -> Angles:
            return [
                np.array([qpos[model.jnt_qposadr[joint]] for joint in leg.joints])
                for leg in self._posed.legs
            ]

        lowest = [shape.lowest_m(np.eye(3), np.zeros(3), np.zeros(3)) for shape in self._torso]
        return RobotWithLegs(
            self._chains,
            [leg.foot.radius_m for leg in self._posed.legs],
            [
                [self._compiled.joint_name(joint) for joint in leg.joints]
                for leg in self._posed.legs
            ],
            min(lowest),
            {name: angles(qpos) for name, qpos in self._keyframes.items()},
            angles(model.qpos0),
        )

    def _tell_of_limits(self) -> None:
        unlimited = [joint for joint in self._joints if self._limits[joint] is None]
        if unlimited:
            which = (
                "all joints" if len(unlimited) == len(self._joints) else f"{len(unlimited)} joints"
            )
            self._notes.guess(
                "joints",
                f"{which} have no limits in the file: 90° to each side of home",
                map(self._compiled.joint_name, unlimited),
            )

    def _ends(self) -> dict[int | None, FloatArray]:
        """Return the two end points of each link in the body frame, (2, 3) [m], by joint."""
        half = np.array([0, 0, self._span()[2]])
        ends: dict[int | None, FloatArray] = {None: np.array([-half, half])}
        for leg, chain in zip(self._posed.legs, self._chains, strict=True):
            points = [*chain.anchors, chain.foot]
            for number, joint in enumerate(leg.joints):
                ends[joint] = np.array(points[number : number + 2])
        return ends

    def _model(
        self,
        names: Mapping[int | None, str],
        masses: Mapping[int | None, Mass],
        servos: Mapping[int, FoundServo],
        meshes: Mapping[int | None, ModelMesh],
        home: Angles,
    ) -> RobotModel:
        torso = _link(names[None], -1, 0, masses[None], at=np.zeros(3), parent_at=np.zeros(3))
        shapes = tuple(shape.as_geom(np.zeros(3)) for shape in self._torso)
        links = [_with(torso, None, shapes, meshes.get(None))]
        feet = []
        kinds = joint_kinds(
            [[self._compiled.joint_name(joint) for joint in leg.joints] for leg in self._posed.legs]
        )
        for number, (leg, chain) in enumerate(
            zip(self._posed.legs, self._chains, strict=True), start=1
        ):
            parent, parent_at = 0, np.zeros(3)
            all_shapes = self._shapes_of(leg, chain, home[number - 1])
            carrying = leg.joints[-1:] if self._has_foot_link(leg) else ()
            for place, joint in enumerate(leg.joints):
                at = chain.anchors[place]
                mass = masses[joint] if joint not in carrying else self._without_foot(leg)
                link = _link(names[joint], parent, number, mass, at=at, parent_at=parent_at)
                home_rad = float(home[number - 1][place])
                turned = self._joint(
                    joint, kinds[number - 1][place], chain.axes[place], home_rad, servos[joint]
                )
                geoms = tuple(shape.as_geom(at) for shape in all_shapes[place])
                parent, parent_at = len(links), at
                links.append(_with(link, turned, geoms, meshes.get(joint)))
            if carrying:
                mass = mass_of(self._posed, [leg.foot.body])
                place_of_foot = {"at": chain.foot, "parent_at": parent_at}
                links.append(_link(quoted(leg.foot.name), parent, number, mass, **place_of_foot))
                parent, parent_at = len(links) - 1, chain.foot
            feet.append(
                ModelFoot(parent, _vector(chain.foot - parent_at), float(leg.foot.radius_m))
            )
        return checked_model(links, feet)

    def _has_foot_link(self, leg: FoundLeg) -> bool:
        """Whether the foot is a link with a mass, as in files that were exported here.

        It stays one, since MuJoCo's contacts depend on the mass of the body that has a foot.
        """
        model, body = self._compiled.model, leg.foot.body
        is_apart = int(model.jnt_bodyid[leg.joints[-1]]) != body and model.body_mass[body] > 0
        return self._exported.keeps_frame and bool(is_apart)

    def _without_foot(self, leg: FoundLeg) -> Mass:
        bodies = self._posed.bodies_of(leg.joints[-1])
        return mass_of(self._posed, [body for body in bodies if body != leg.foot.body])

    def _joint(
        self, joint: int, name: str, axis: FloatArray, home_rad: float, servo: FoundServo
    ) -> ModelJoint:
        low, high = self._limits[joint] or limits_around(home_rad)
        return ModelJoint(
            name,
            _vector(axis),
            (0.0, 0.0, 0.0),
            (low, high),
            min(max(home_rad, low), high) + 0.0,
            servo.kp,
            servo.kv,
            servo.torque_nm,
            servo.armature,
            servo.damping,
            servo.friction_nm,
        )

    def _shapes_of(
        self, leg: FoundLeg, chain: LegChain, angles: FloatArray
    ) -> list[list[GroundShape]]:
        """Return the shapes of each link of a leg that touch nothing at home."""
        foot = self._posed.foot(leg), leg.foot.radius_m
        ground_m = float(chain.feet(angles[None])[0, 2]) - leg.foot.radius_m
        shapes_of_links = []
        turn, moved = np.eye(3), np.zeros(3)
        origin = np.zeros(3)
        for place, joint in enumerate(leg.joints):
            at = chain.anchors[place]
            moved = moved + turn @ (at - origin)
            turn = turn @ _turned(chain.axes[place], float(angles[place]))
            origin = at
            is_last = place + 1 == len(leg.joints)
            shapes = link_shapes(self._posed, joint, foot if is_last else None)
            lowest = [shape.lowest_m(turn, at, moved) for shape in shapes]
            shapes_of_links.append(drop_touching(shapes, lowest, ground_m, self._notes))
        return shapes_of_links

    def _name_of_torso(self) -> str:
        return quoted(self._compiled.body_name(self._posed.skeleton.root))

    def _name_of_link(self, joint: int) -> str:
        body = int(self._compiled.model.jnt_bodyid[joint])
        return quoted(self._compiled.body_name(body))


def _vector(values: FloatArray) -> tuple[float, float, float]:
    x, y, z = (float(value) + 0.0 for value in values)
    return x, y, z


def _turned(axis: FloatArray, angle: float) -> FloatArray:
    """Return the rotation about an axis, (3, 3)."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    rotation: FloatArray = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    return rotation


def _link(
    name: str, parent: int, leg: int, mass: Mass, *, at: FloatArray, parent_at: FloatArray
) -> ModelLink:
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = (mass.inertia + 0.0).tolist()
    return ModelLink(
        name,
        parent,
        leg,
        _vector(at - parent_at),
        (1.0, 0.0, 0.0, 0.0),
        mass.kg,
        _vector(mass.center_m - at),
        (xx, yy, zz, xy, xz, yz),
    )


def _with(
    link: ModelLink,
    joint: ModelJoint | None,
    geoms: tuple[ModelGeom, ...],
    mesh: ModelMesh | None,
) -> ModelLink:
    return replace(link, joint=joint, geoms=geoms, mesh=mesh)
