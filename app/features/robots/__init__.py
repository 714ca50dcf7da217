"""Robots that people make: bodies that they edit, and files of robots, stored under a name.

The store of robots, and what is known of one before it walks, are the core's: a run names a robot
by its id, and the form tells of any robot.

- `feature` is what the core sees of it; `body_fields` has the numbers that the editor offers.
- `robot_import` stores a body, a document or a file, and reads a file again as a person decided.
- `readings` keeps files that are looked at before a robot is stored, `reading_view` tells what is
  in one, with a picture.
- Over REST: `routes`, `response_models`.
- On the command line (`commands`): `robots_command` has `hexapods robots` with the verbs that
  read, `storing_commands` those that change which are stored.
"""
