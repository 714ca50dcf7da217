"""Physics by MuJoCo.

- `mjcf`: builds a MuJoCo model from a `Robot`; `model_spec`: from a robot of a file.
- `conditions`: changes the model to what happens to the robot and the ground.
- `mujoco_simulator`: the simulator on that model, for single steps and batches.
- `servo_torque`: torque and work of the servos in a step.
- `engine`: which MuJoCo is loaded. Importing this package warns of another than the pinned one.
"""

from hexapods.physics.engine import warn_of_mismatch

warn_of_mismatch()
