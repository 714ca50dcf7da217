"""Robots from files of strangers: MJCF or URDF, alone or in a zip with meshes.

`child.read_robot_file` is what others call: it reads a file in a child process with limits. There
`reading` goes through the steps, each a module: `upload` unpacks, `xml` reads the document within
bounds, `mjcf` and `urdf` keep of it what describes a body, `compiling` has MuJoCo turn it into
numbers, `skeleton` finds the torso, legs and feet, `directions` tells forward and numbers the legs,
`stance` finds how it stands, `servos` their strength, `shapes` what touches the ground, `drawing`
what is drawn, and `building` makes a `RobotModel` of all. Guesses and repairs are told in `notes`.
"""
