"""Physics by MuJoCo.

- `mjcf`: builds a MuJoCo model from a `Robot`.
- `mujoco_simulator`: the simulator on that model, for single steps and batches.
"""
