"""Robots from files of strangers: MJCF, URDF or xacro, alone or in a zip with meshes.

`child.read_robot_file` is what the rest of the product calls: it reads a file in a child process
with limits (docs/decisions/0011). In the child `reading` goes through the steps:

- `documents` finds the document that is the robot, and makes it whole.
- `mjcf` and `urdf` keep of it what describes a body; `meshes` reads and simplifies its meshes.
- `compiling` has MuJoCo turn it into numbers, in the `units` of the file and without
  `incomplete_shapes`; `posed_robot` is the robot with all joints at 0, `upright` tells which axis
  is up.
- `legs` finds the legs, forward and the stance; `masses` and `servos` fill in what is missing;
  `shapes` finds what touches the ground, from `surfaces`; `drawing` what is drawn; `size` tells
  what does not fit.
- `exported_settings` and `exported_pose` read what a file that was exported here says of its robot.
- `building` makes a `RobotModel` of all, within `link_limits`, `sketch` a picture of the bodies in
  the file, for a person who corrects what was guessed. `choices` are decisions of a person,
  `notes` guesses and repairs, `imported` the result.
"""
