"""Draws frames of runs in viser.

- `scene` draws a frame: `track`, `robots`, `footgrid`, `ghosts`; and what happens in its world:
  `lane_ground`, `payload_and_push`, `condition_colors`. `temporary` are nodes that come and go.
- `lane_marks` are painted on the track; `contact_shadows` lie under robots. Both are meshes of
  `glb`, which lights do not shade; how the scene looks in a theme, says `static/viewer/light.js`.
- `robot_mesh` builds meshes from the MJCF; `shapes` and `colormap` are its primitives.
- `sketch` draws a robot on a turntable, before it is stored.
- `replay_encoding` encodes a replay's frames as messages that a page plays by itself, and ghosts of
  `posture`; `pose_tracks` compresses the poses in them.
- `viser_internals` has all that rests on viser's private parts, and the list of what is assumed. To
  take a new version of viser, pin it in pyproject.toml and run
  `tests/drawing/viser_internals`: each assumption that it breaks is named by a test.
"""
