"""Small robots in MJCF and URDF, written for the tests, and zips of them."""

import io
import math
import zipfile
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from hexapods.imports.choices import AS_FOUND, Choices
from hexapods.imports.compiling import silence_mujoco
from hexapods.imports.imported import ImportedRobot, RobotReading
from hexapods.imports.reading import read_in_this_process

Mounts = Mapping[str, tuple[float, float]]
FOUR: Mounts = {"FL": (0.2, 0.1), "FR": (0.2, -0.1), "RL": (-0.2, 0.1), "RR": (-0.2, -0.1)}
SIX: Mounts = {
    "lf": (0.12, 0.06),
    "lm": (0.0, 0.1),
    "lr": (-0.12, 0.06),
    "rf": (0.12, -0.06),
    "rm": (0.0, -0.1),
    "rr": (-0.12, -0.06),
}
HOME = "0 0 0.3 1 0 0 0" + 4 * " 0 0.7 -1.4"


def read(data: str | bytes, name: str = "robot.xml", choices: Choices = AS_FOUND) -> ImportedRobot:
    """Read a robot in this process, since these are no stranger's."""
    return inspect(data, name, choices).valid_robot()


def inspect(
    data: str | bytes, name: str = "robot.xml", choices: Choices = AS_FOUND
) -> RobotReading:
    """Read a robot, or why there is none, in this process."""
    silence_mujoco()
    content = data.encode() if isinstance(data, str) else data
    return read_in_this_process(content, name, choices)


def dog(
    legs: Mounts = FOUR,
    *,
    base: str = "<freejoint/>",
    actuators: str = '<position joint="{joint}" kp="40" forcerange="-20 20"/>',
    keyframes: Mapping[str, str] | None = None,
    limits: bool = True,
    on_torso: str = "",
    on_shank: str = "",
    foot: str = '<geom name="{leg}" type="sphere" size="0.02" pos="0 0 -0.2" mass="0.05"/>',
    sections: str = "",
) -> str:
    """Return a quadruped in MJCF, with legs of two links of 0.2 m below their hips.

    Args:
        legs: where each is mounted.
        base: joint of the torso.
        actuators: of each joint; `{joint}` is its name.
        keyframes: `qpos` by name.
        limits: whether joints have some.
        on_torso: what else is in the torso.
        on_shank: what else is in each shank; `{leg}` is the leg's name.
        foot: geom of a foot.
        sections: what else is in the document.
    """
    ranges = {"hip": "-0.8 0.8", "thigh": "-1 3", "calf": "-2.7 -0.5"}
    if not limits:
        ranges = {}

    def joint(leg: str, kind: str, axis: str) -> str:
        span = f' range="{ranges[kind]}"' if kind in ranges else ""
        return f'<joint name="{leg}_{kind}_joint" axis="{axis}"{span}/>'

    bodies = "".join(
        f"""<body name="{leg}_hip" pos="{x} {y} 0">{joint(leg, "hip", "1 0 0")}
        <geom type="sphere" size="0.03" mass="0.3"/>
        <body name="{leg}_thigh" pos="0 {math.copysign(0.05, y)} 0">{joint(leg, "thigh", "0 1 0")}
          <geom type="capsule" fromto="0 0 0 0 0 -0.2" size="0.015" mass="0.4"/>
          <body name="{leg}_calf" pos="0 0 -0.2">{joint(leg, "calf", "0 1 0")}
            <geom type="capsule" fromto="0 0 -0.02 0 0 -0.16" size="0.01" mass="0.1"/>
            {foot.format(leg=leg)}{on_shank.format(leg=leg)}
          </body></body></body>"""
        for leg, (x, y) in legs.items()
    )
    names = [f"{leg}_{kind}_joint" for leg in legs for kind in ("hip", "thigh", "calf")]
    keys = "".join(
        f'<key name="{name}" qpos="{qpos}"/>' for name, qpos in (keyframes or {}).items()
    )
    return f"""<mujoco model="dog">
      <compiler angle="radian"/>
      <worldbody><geom type="plane" size="5 5 1"/><light pos="0 0 3"/>
      <body name="trunk" pos="0 0 0.4">{base}
        <geom name="box" type="box" size="0.2 0.08 0.05" mass="5"/>{on_torso}{bodies}
      </body></worldbody>
      <actuator>{"".join(actuators.format(joint=name) for name in names)}</actuator>
      <keyframe>{keys}</keyframe>{sections}
    </mujoco>"""


INERTIAL = (
    '<inertial><origin xyz="0.04 0 0"/><mass value="0.1"/>'
    '<inertia ixx="1e-4" iyy="2e-4" izz="2e-4" ixy="0" ixz="0" iyz="0"/></inertial>'
)


def link(name: str, inertial: str = INERTIAL, shapes: str = "") -> str:
    return f'<link name="{name}">{inertial}{shapes}</link>'


def bug(
    legs: Mounts = SIX,
    *,
    inertial: str = INERTIAL,
    torso_inertial: str = INERTIAL.replace("0.1", "1.5"),
    torso: str = '<collision><geometry><box size="0.2 0.1 0.04"/></geometry></collision>',
    femur: str = '<collision><geometry><cylinder radius="0.01" length="0.06"/></geometry>'
    "</collision>",
    tip: str = '<collision><origin xyz="0.12 0 0"/><geometry><sphere radius="0.008"/></geometry>'
    "</collision>",
    limit: str = '<limit lower="-1.6" upper="1.6" effort="{effort}" velocity="5"/>',
    effort: str = "2.5",
    kind: str = "revolute",
    more: str = "",
) -> str:
    """Return a hexapod in URDF whose legs stretch outward at the angles 0.

    Args:
        legs: where each is mounted.
        inertial: of the links of legs.
        torso_inertial: of the torso.
        torso: shapes of the torso.
        femur: shapes of each femur.
        tip: shapes of each tibia.
        limit: of each joint.
        effort: of each joint.
        kind: type of the joints.
        more: what else is in the document.
    """
    parts = [link("base_link", torso_inertial, torso)]
    for leg, (x, y) in legs.items():
        yaw = math.atan2(y, x)
        parts += [
            link(f"coxa_{leg}", inertial),
            link(f"femur_{leg}", inertial, femur),
            link(f"tibia_{leg}", inertial, tip),
            joint(
                f"j_coxa_{leg}",
                kind,
                "base_link",
                f"coxa_{leg}",
                at=(x, y, 0),
                yaw=yaw,
                axis="0 0 1",
            ),
            joint(f"j_femur_{leg}", kind, f"coxa_{leg}", f"femur_{leg}", at=(0.05, 0, 0)),
            joint(f"j_tibia_{leg}", kind, f"femur_{leg}", f"tibia_{leg}", at=(0.08, 0, 0)),
        ]
    text = "".join(parts).replace("<!--limit-->", limit.format(effort=effort))
    return f'<?xml version="1.0"?>\n<robot name="bug">{text}{more}</robot>'


def joint(
    name: str,
    kind: str,
    parent: str,
    child: str,
    *,
    at: tuple[float, float, float],
    yaw: float = 0,
    axis: str = "0 1 0",
) -> str:
    """Return a joint of a URDF; its limit is filled in later."""
    x, y, z = at
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{x} {y} {z}" rpy="0 0 {yaw}"/><axis xyz="{axis}"/><!--limit--></joint>'
    )


def zipped(files: Mapping[str, Any]) -> bytes:
    """Return a zip of texts and bytes by path."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return buffer.getvalue()


def box_triangles(sides: Sequence[float], cells: int = 1) -> np.ndarray:
    """Return the triangles of a box around the origin, (n, 3, 3), each side divided into cells."""
    steps = np.linspace(-0.5, 0.5, cells + 1)
    triangles = []
    for axis in range(3):
        for side in (-0.5, 0.5):
            for i in range(cells):
                for j in range(cells):
                    corners = np.empty((4, 3))
                    corners[:, axis] = side
                    corners[:, (axis + 1) % 3] = steps[[i, i + 1, i + 1, i]]
                    corners[:, (axis + 2) % 3] = steps[[j, j, j + 1, j + 1]]
                    if side < 0:
                        corners = corners[::-1]
                    triangles += [corners[[0, 1, 2]], corners[[0, 2, 3]]]
    return np.array(triangles) * sides


def stl(triangles: np.ndarray) -> bytes:
    """Return a binary STL."""
    kind = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    records = np.zeros(len(triangles), kind)
    records["corners"] = triangles
    return bytes(80) + len(triangles).to_bytes(4, "little") + records.tobytes()


def text_stl(triangles: np.ndarray) -> bytes:
    """Return an STL as text."""
    facets = "".join(
        "facet normal 0 0 0\nouter loop\n"
        + "".join(f"vertex {x:.6f} {y:.6f} {z:.6f}\n" for x, y, z in corners)
        + "endloop\nendfacet\n"
        for corners in triangles
    )
    return f"solid box\n{facets}endsolid box\n".encode()
