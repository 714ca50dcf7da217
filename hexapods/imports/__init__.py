"""Robots from files of strangers: MJCF, URDF or xacro, alone or in a zip with meshes.

`child.read_robot_file` is what the rest of the product calls: it reads a file in a child process
with limits (docs/decisions/0011). `folder` packs a folder or a repository into such a file. In the
child `reading` goes through the steps:

- `upload` unpacks, and finds files by the ends of their paths. `documents` chooses the document
  that is the robot, which `xml` reads within bounds, `lenient_xml` first if it is not well-formed;
  `includes` puts what MJCF includes in its place, and `xacro` expands macros, by `xacro_scope`,
  `expressions` and `yaml_values`. `other_formats` says what any other file is.
- `mjcf` and `urdf` keep of a document what describes a body; `mesh_files` and `decimation` read
  and simplify meshes (`stl`, `obj`, `collada`, `gltf`).
- `compiling` has MuJoCo turn it into numbers, in the `units` of the file and without
  `incomplete_shapes`; `posed_robot` is the robot with all joints at 0.
- `upright` tells which axis is up; `skeleton` finds the torso and the legs, `feet` their feet, and
  `closed_loops` those to which two chains lead; `directions` tells forward, by the names of
  `sides`, and numbers the legs; `stance` finds how the robot stands, by the kinematics of `chain`
  and `reach`, `heights` how high it could; `joint_kinds` names the joints; `masses` and `servos`
  fill in what is missing; `shapes` finds what touches the ground, from `surfaces`; `drawing` what
  is drawn; `size` and `balance` tell what does not fit and what topples.
- `exported_settings` and `exported_pose` read what a file that was exported here says of its robot.
- `building` makes a `RobotModel` of all, within `link_limits`, `sketch` a picture of the bodies in
  the file, for a person who corrects what was guessed. `choices` are decisions of a person,
  `notes` guesses and repairs, `imported` the result.
"""
