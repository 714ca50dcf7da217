"""Draws the sketch of a robot on a turntable: its bodies, coloured by groups, and its feet."""

import math
from collections.abc import Sequence

import numpy as np
import viser

from hexapods.domain.gait import Gait
from hexapods.domain.kinematics import legs_of
from hexapods.domain.model_geometry import quaternion_matrix
from hexapods.domain.robot import Robot
from hexapods.domain.robot_model import ModelMesh, Vector
from hexapods.domain.types import FloatArray
from hexapods.drawing.colormap import Rgb, rgb
from hexapods.drawing.contact_shadows import SHADOWS, TORSO_REACH, add_shadows
from hexapods.drawing.robot_mesh import RobotMesh
from hexapods.drawing.shapes import Shape, disc, joined
from hexapods.drawing.track import WORLD, draw_ground
from hexapods.imports.imported import Sketch, SketchFoot, SketchPart

SKETCH_ROOT = f"{WORLD}/sketch"
GROUP_COLORS = ("#7d63f7", "#e25c8d", "#25a493", "#c08a1e", "#6a8aac", "#9a9a2a")
"""Between those that the page has for groups in light and in dark."""
_PART: Rgb = (118, 126, 140)
FOOT: Rgb = (255, 176, 32)
_TABLE: Rgb = (150, 160, 178)
TABLE_MARGIN, _TABLE_CORNERS = 1.12, 96
"""Radius of the turntable relative to that of the robot."""
_ABOVE_M = 0.0005
"""Height of the turntable over the ground, for a robot of the usual size."""
_SHADOWS_ABOVE_M = 0.0015
"""Height of the shadows over the ground, for a robot of the usual size."""
_USUAL_M = 0.35
"""Radius of a robot of the usual size."""
_FOOT_SHADOW = 2.2
"""Radius of the shadow of a foot, which fades out, relative to the foot's."""


def draw_sketch(
    server: viser.ViserServer, sketch: Sketch, groups: Sequence[Sequence[int]] = ()
) -> None:
    """Draw a sketch on an empty stage.

    The bodies are the nodes `part/0`, `part/1`… below `SKETCH_ROOT`, the feet `foot/0`….

    Args:
        server: where to draw.
        sketch: bodies and feet.
        groups: legs of each group, from 1; without any all legs have one colour.
    """
    draw_ground(server)
    radius_m = radius_of(sketch)
    size = radius_m / _USUAL_M
    scene = server.scene
    scene.add_frame(SKETCH_ROOT, show_axes=False)
    table = disc(radius_m * TABLE_MARGIN, _TABLE_CORNERS)
    scene.add_mesh_simple(
        f"{SKETCH_ROOT}/table",
        table.vertices,
        table.faces,
        color=_TABLE,
        opacity=0.55,
        position=(0.0, 0.0, _ABOVE_M * size),
    )
    _draw_shadows(server, sketch, size)
    for number, part in enumerate(sketch.parts):
        if part.mesh is not None:
            corners, faces = part.mesh.arrays()
            scene.add_mesh_simple(
                f"{SKETCH_ROOT}/part/{number}",
                corners,
                faces,
                color=part_color(part.leg, groups),
                flat_shading=True,
                side="double",
            )
    for number, foot in enumerate(sketch.feet):
        scene.add_icosphere(
            f"{SKETCH_ROOT}/foot/{number}",
            radius=1.25 * foot.radius_m + 0.004 * size,
            color=FOOT,
            opacity=0.75,
            position=foot.at_m,
        )


def _draw_shadows(server: viser.ViserServer, sketch: Sketch, size: float) -> None:
    """Draw the shadows of a torso and of feet, which are on the turntable or nearly so."""
    places, radii = [], []
    torso = [p.mesh.arrays()[0] for p in sketch.parts if not p.leg and p.mesh is not None]
    if torso:
        vertices = np.concatenate(torso)[:, :2]
        low, high = vertices.min(axis=0), vertices.max(axis=0)
        places.append((low + high) / 2)
        radii.append(TORSO_REACH * (high - low) / 2)
    for foot in sketch.feet:
        places.append(np.array(foot.at_m[:2]))
        radii.append(np.full(2, _FOOT_SHADOW * foot.radius_m))
    if places:
        positions = np.column_stack([places, np.full(len(places), _SHADOWS_ABOVE_M * size)])
        add_shadows(server, f"{SKETCH_ROOT}/{SHADOWS}", positions, np.array(radii))


def radius_of(sketch: Sketch) -> float:
    """Return the radius of a circle on the ground around all of a sketch [m]."""
    vertices = [part.mesh.arrays()[0] for part in sketch.parts if part.mesh is not None]
    points = [*vertices, np.array([foot.at_m for foot in sketch.feet]).reshape(-1, 3)]
    return max(0.01, *(float(np.linalg.norm(at[:, :2], axis=1).max(initial=0.0)) for at in points))


def sketch_body(robot: Robot, gait: Gait) -> Sketch:
    """Return the sketch of any robot as it stands; where a foot is out of reach, with it left out.

    Args:
        robot: the robot.
        gait: says where its forward is.
    """
    legs = legs_of(robot)
    angles = legs.under(gait).joint_angles(np.zeros((len(legs), 3)))
    height_m = robot.body_height_m + robot.foot_radius_m
    mesh = RobotMesh(robot)
    poses = mesh.body_poses(np.concatenate(([0, 0, height_m, 1, 0, 0, 0], np.nan_to_num(angles))))
    forward = _turn(math.radians(90 - gait.forward_deg))
    shapes: dict[int, list[Shape]] = {}
    for part in mesh.body_parts:
        for link in part.links.tolist():
            shapes.setdefault(link, []).append(part.shape)
    parts = []
    for link, link_shapes in shapes.items():
        rotation = forward @ quaternion_matrix(poses.rotations[link])
        shape = joined(link_shapes).moved(rotation, forward @ poses.positions[link])
        joint = mesh.joint_of(link)
        low_m = shape.vertices[int(shape.vertices[:, 2].argmin())]
        parts.append(
            SketchPart(
                "torso" if joint is None else joint.label,
                0 if joint is None else joint.leg,
                None,
                _vector((shape.vertices.min(axis=0) + shape.vertices.max(axis=0)) / 2),
                _vector(low_m),
                ModelMesh.of(shape.vertices, shape.faces),
            )
        )
    places = legs.links_in_body(angles.tolist())
    feet = tuple(
        SketchFoot(
            f"leg {leg}",
            leg,
            _vector(forward @ links[-1] + np.array([0, 0, height_m])),
            robot.foot_radius_m,
        )
        for leg, links in enumerate(places, start=1)
        if np.isfinite(links).all()
    )
    return Sketch(tuple(parts), feet)


def _turn(angle_rad: float) -> FloatArray:
    """Return the rotation about z, (3, 3)."""
    cos, sin = math.cos(angle_rad), math.sin(angle_rad)
    return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])


def _vector(point: FloatArray) -> Vector:
    x, y, z = (round(float(value), 6) + 0.0 for value in point)
    return x, y, z


def part_color(leg: int, groups: Sequence[Sequence[int]]) -> Rgb:
    """Return the colour of a body: that of its leg's group, or the first where it is in none.

    Args:
        leg: number of its leg, from 1; 0 for what is of no leg.
        groups: legs of each group, from 1.
    """
    if not leg:
        return _PART
    number = next((number for number, group in enumerate(groups) if leg in group), 0)
    return rgb(GROUP_COLORS[number % len(GROUP_COLORS)])
