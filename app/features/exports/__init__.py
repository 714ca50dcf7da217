"""A recorded walk as files for other programs; `hexapods.exports` has the formats.

- `feature` is what the core sees of it; `routes` has a route for each format, and `options` what
  the options say of them.
- `stored_walks`: the recorded walk of a stored run that has ended.
- `file_renderer`: renders large files one at a time, in a process of lower priority.
- `commands` names the modules of its commands, verbs of `hexapods runs`: `file_commands` has one
  for each format, and `servos_command` writes files for the servos of a real robot.
"""
