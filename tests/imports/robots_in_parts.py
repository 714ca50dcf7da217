"""Small robots of several files: MJCF with includes, and xacro as ROS packages have it."""

from tests.imports.robots import HOME, SIX, dog

_LEG = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="mass" value="0.1"/>
  <xacro:macro name="inertia" params="mass:=${mass} *origin">
    <inertial><xacro:insert_block name="origin"/><mass value="${mass}"/>
      <inertia ixx="1e-4" iyy="2e-4" izz="2e-4" ixy="0" ixz="0" iyz="0"/></inertial>
  </xacro:macro>
  <xacro:macro name="joint" params="name parent child xyz yaw:=0 axis:='0 1 0'">
    <joint name="${name}" type="revolute"><parent link="${parent}"/><child link="${child}"/>
      <origin xyz="${xyz}" rpy="0 0 ${yaw}"/><axis xyz="${axis}"/>
      <limit lower="${-limit}" upper="${limit}" effort="$(arg effort)" velocity="5"/></joint>
  </xacro:macro>
  <xacro:macro name="leg" params="leg x y **more">
    <xacro:property name="yaw" value="${atan2(y, x)}"/>
    <link name="coxa_${leg}"><xacro:inertia><origin xyz="0.04 0 0"/></xacro:inertia></link>
    <link name="femur_${leg}"><xacro:inertia><origin xyz="0.04 0 0"/></xacro:inertia>
      <collision><geometry><cylinder radius="0.01" length="0.06"/></geometry></collision></link>
    <link name="tibia_${leg}"><xacro:inertia><origin xyz="0.04 0 0"/></xacro:inertia>
      <xacro:insert_block name="more"/></link>
    <xacro:joint name="j_coxa_${leg}" parent="base_link" child="coxa_${leg}" xyz="${x} ${y} 0"
      yaw="${yaw}" axis="0 0 1"/>
    <xacro:joint name="j_femur_${leg}" parent="coxa_${leg}" child="femur_${leg}"
      xyz="${lengths['coxa']} 0 0"/>
    <xacro:joint name="j_tibia_${leg}" parent="femur_${leg}" child="tibia_${leg}"
      xyz="${lengths.femur} 0 0"/>
  </xacro:macro>
</robot>"""
_CALLS = "".join(
    f'<xacro:leg leg="{leg}" x="{x}" y="{y}"><tip><collision><origin xyz="0.12 0 0"/><geometry>'
    '<sphere radius="${tip}"/></geometry></collision></tip></xacro:leg>'
    for leg, (x, y) in SIX.items()
)
_MAIN = f"""<?xml version="1.0"?>
<robot name="bug" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="effort" default="2.5"/>
  <xacro:arg name="sim" default="false"/>
  <xacro:property name="lengths" value="${{xacro.load_yaml('$(find bug)/config/legs.yaml')}}"/>
  <xacro:property name="tip" value="${{lengths.tip_mm / 1000}}"/>
  <xacro:property name="limit" value="1.6"/>
  <xacro:include filename="$(find bug)/urdf/leg.xacro"/>
  <xacro:include filename="$(find other_package)/urdf/camera.xacro"/>
  <link name="base_link"><xacro:inertia mass="1.5"><origin xyz="0.04 0 0"/></xacro:inertia>
    <collision><geometry><box size="0.2 0.1 0.04"/></geometry></collision></link>
  <xacro:if value="$(arg sim)"><gazebo/><link name="sim"/></xacro:if>
  {_CALLS}
  <xacro:camera parent="base_link"/>
  <gazebo><plugin filename="$(find gazebo)/${{nothing}}"/></gazebo>
</robot>"""


def in_parts() -> dict[str, str]:
    """Return the quadruped `dog(keyframes={"home": HOME})` in three MJCF files by path."""
    text = dog(keyframes={"home": HOME})
    start, end = text.index("<actuator>"), text.index("</mujoco>")
    return {
        "dog/scene.xml": (
            '<mujoco><include file="parts/bodies.xml"/><include file="sections.xml"/></mujoco>'
        ),
        "dog/parts/bodies.xml": f"{text[:start]}</mujoco>",
        "dog/sections.xml": f"<mujoco>{text[start:end]}</mujoco>",
    }


def in_xacro() -> dict[str, str]:
    """Return the hexapod `bug()` as a ROS package in xacro, by path; its camera is missing."""
    return {
        "repo/package.xml": "<package><name>bug</name></package>",
        "repo/urdf/bug.urdf.xacro": _MAIN,
        "repo/urdf/leg.xacro": _LEG,
        "repo/config/legs.yaml": "coxa: 0.05\nfemur: 0.08\ntip_mm: 8\n",
    }
