"""Import of robots: `robot_import` takes a body, the document of a robot, or a robot's file."""
