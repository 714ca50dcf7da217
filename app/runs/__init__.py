"""The two loops, training and race, and what they need; neither knows web, database or engine.

`config` is what a user asks for. `training` and `racing` are the loops; both drive a `walker`, a
robot with an agent on it, and yield `records`. `recording` keeps motion for drawing, `clocks` and
`results` time a race, `tables` and `table_file` store what was learned, `seeding` spawns
generators.
"""
