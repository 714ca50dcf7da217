"""Physics by MuJoCo.

- `mjcf`: builds a MuJoCo model from a `Robot`.
- `conditions`: changes the model to what happens to the robot and the ground.
- `mujoco_simulator`: the simulator on that model, for single steps and batches.
"""
