"""Draws frames of runs in viser.

- `scene` draws a frame: `track`, `robots`, `footgrid`, `ghosts`; and what happens in its world:
  `lane_ground`, `payload_and_push`, `condition_colors`.
- `robot_mesh` builds meshes from the MJCF; `shapes` and `colormap` are its primitives.
- `replay_encoding` encodes a replay's frames as messages that a page plays by itself, and ghosts of
  `posture`.
- `viser_internals` has all that rests on viser's private parts, and the list of what is assumed.
"""
