"""Open exported robots in the programs that people have: `python -m tests.other_readers`.

Each reader gets an environment of its own below build/readers, of the newest packages that go
together; MuJoCo's build for WebAssembly is from npm. Where one cannot be installed that is said,
since nothing was compared. It downloads half a gigabyte the first time, so that no tier of the
tests has it: run it when `hexapods/exports/mjcf_text.py` or `urdf.py` change.
"""

import json
import subprocess
import sys
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path

import mujoco
import numpy as np

from hexapods.domain.creatures import PRESETS
from hexapods.domain.model_robot import model_robot
from hexapods.domain.robot import Robot
from hexapods.exports.robot_files import ROBOT_FILES
from hexapods.physics.mjcf import compile_visual_model
from tests.digests import ROOT
from tests.model_robots import mixed_model, quadruped_model, two_joint_model, with_meshes

_FOLDER = ROOT / "build" / "readers"
_STEPS = 500
_NEAR_M = 1e-6
"""Farthest that other versions of MuJoCo may have the torso after these steps."""
_ROBOTS: Mapping[str, Robot] = {
    **PRESETS,
    "meshes": model_robot(with_meshes(quadruped_model()), "meshes"),
    "mixed": model_robot(mixed_model(), "mixed"),
    "two_joints": model_robot(two_joint_model(), "two_joints"),
}
_STANDS = f"""
import json, sys, mujoco
for file in sys.argv[1:]:
    model = mujoco.MjModel.from_xml_path(file)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_step(model, data, {_STEPS})
    print(json.dumps(data.qpos[:3].tolist()))
"""
_PARSES = """
import sys
from dm_control import mjcf
for file in sys.argv[1:]:
    root = mjcf.from_path(file)
    print([len(root.find_all("joint")) - 1, len(root.actuator.position), len(root.keyframe.key)])
"""
_LOADS = """
import os, sys, types
from robot_descriptions.loaders.yourdfpy import load_robot_description
for file in sys.argv[1:]:
    module = types.ModuleType("robot_descriptions.exported_description")
    module.URDF_PATH, module.PACKAGE_PATH = file, os.path.dirname(file)
    sys.modules[module.__name__] = module
    robot = load_robot_description("exported_description")
    assert robot.validate(), robot.errors
    masses = (link.inertial.mass for link in robot.robot.links if link.inertial)
    print([len(robot.actuated_joint_names), round(sum(masses), 6)])
"""
_STANDS_IN_WASM = f"""
import {{ readFileSync }} from "node:fs";
import load from "@mujoco/mujoco";
const mujoco = await load();
for (const file of process.argv.slice(2)) {{
  const model = mujoco.MjModel.from_xml_string(readFileSync(file, "utf8"));
  const data = new mujoco.MjData(model);
  mujoco.mj_resetDataKeyframe(model, data, 0);
  for (let step = 0; step < {_STEPS}; step += 1) mujoco.mj_step(model, data);
  console.log(JSON.stringify([...data.qpos].slice(0, 3)));
  data.delete();
  model.delete();
}}
"""


def main() -> int:
    """Compare; return 0 if all readers that are here read the robots as they are, else 1."""
    mjcf, urdf = _written()
    models = {name: compile_visual_model(robot) for name, robot in _ROBOTS.items()}
    joints = {name: [model.nu, model.nu, 1] for name, model in models.items()}
    masses = {
        name: [model.nu, round(float(model.body_mass.sum()), 6)] for name, model in models.items()
    }
    stood = {name: _stands(file) for name, file in mjcf.items()}
    results = [
        _compare("MuJoCo 3.2.0", ["mujoco==3.2.0"], _STANDS, mjcf, stood),
        _compare("newest MuJoCo, as mink has it", ["mink"], _STANDS, mjcf, stood),
        _compare("dm_control.mjcf", ["dm_control"], _PARSES, mjcf, joints),
        _compare(
            "yourdfpy by robot_descriptions",
            ["robot_descriptions", "yourdfpy"],
            _LOADS,
            urdf,
            masses,
        ),
        _compare_wasm(mjcf, stood),
    ]
    return 0 if all(results) else 1


def _written() -> tuple[dict[str, Path], dict[str, Path]]:
    """Write the robots as MJCF, and as URDF with meshes; return the documents by name."""
    mjcf, urdf = {}, {}
    for name, robot in _ROBOTS.items():
        folder = _FOLDER / "robots" / name
        folder.mkdir(parents=True, exist_ok=True)
        mjcf[name] = folder / f"{name}.xml"
        mjcf[name].write_bytes(ROBOT_FILES["xml"].write(robot))
        packed = folder / f"{name}.zip"
        packed.write_bytes(ROBOT_FILES["zip"].write(robot))
        with zipfile.ZipFile(packed) as archive:
            archive.extractall(folder)
        urdf[name] = next(folder.glob("*.urdf"))
    return mjcf, urdf


def _stands(file: Path) -> list[float]:
    model = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_step(model, data, _STEPS)
    place: list[float] = data.qpos[:3].tolist()
    return place


def _compare(
    title: str,
    packages: Sequence[str],
    program: str,
    files: Mapping[str, Path],
    expected: Mapping[str, list[float]],
) -> bool:
    """Run a program of a reader in an environment with its packages."""
    folder = _FOLDER / packages[0].replace("=", "")
    python = folder / "bin" / "python"
    if not python.exists():
        _run([sys.executable, "-m", "venv", str(folder)])
    installed = _run([str(python), "-m", "pip", "install", "--quiet", *packages])
    if installed.returncode:
        print(f"{title}: was not compared, as it does not install: {installed.stderr[-300:]}")
        return True
    return _same(title, [str(python), "-c", program], files, expected)


def _compare_wasm(files: Mapping[str, Path], expected: Mapping[str, list[float]]) -> bool:
    """Run MuJoCo's build for WebAssembly in Node."""
    title, folder = "MuJoCo for WebAssembly", _FOLDER / "wasm"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "package.json").write_text('{"type": "module"}')
    (folder / "stands.js").write_text(_STANDS_IN_WASM)
    tools = Path(sys.executable).parent
    npm = [str(tools / "npm"), "install", "--ignore-scripts", "@mujoco/mujoco"]
    installed = subprocess.run(npm, cwd=folder, capture_output=True, text=True, check=False)
    if installed.returncode:
        print(f"{title}: was not compared, as it does not install: {installed.stderr[-300:]}")
        return True
    return _same(title, [str(tools / "node"), str(folder / "stands.js")], files, expected)


def _same(
    title: str,
    command: list[str],
    files: Mapping[str, Path],
    expected: Mapping[str, list[float]],
) -> bool:
    """Whether a program prints what is expected, a line of JSON for each file."""
    done = _run([*command, *map(str, files.values())])
    lines = [line for line in done.stdout.splitlines() if line.startswith("[")]
    if done.returncode or len(lines) != len(files):
        print(f"{title}: cannot read {[*files][len(lines)]}: {done.stderr[-500:]}")
        return False
    off = {
        name: float(np.abs(np.subtract(json.loads(line), expected[name])).max())
        for name, line in zip(files, lines, strict=True)
    }
    worst = max(off, key=off.__getitem__)
    print(f"{title}: {len(files)} robots, {worst} differs most, by {off[worst]:.1e}")
    return off[worst] <= _NEAR_M


def _run(command: list[str]) -> subprocess.CompletedProcess[str]:
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)


if __name__ == "__main__":
    sys.exit(main())
