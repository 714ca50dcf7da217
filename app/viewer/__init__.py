"""The 3D viewer: a viser server without a listener, relayed read-only to many browsers.

- `service` assembles the viewer and its routes; `stage_loop` is the drawing thread.
- `scene` draws a stage frame in viser: `track`, `robots`, `footgrid`, `ghosts`; and what happens in
  its world: `lane_ground`, `payload_and_push`, `condition_colors`.
- `robot_mesh` builds meshes from the MJCF; `shapes` and `colormap` are its primitives.
- `hub` relays viser's stream to browsers, one `session` each; `snapshot` serves late joiners.
- `replay_frames` encodes the frames of a run for pages that play it by themselves, and the ghosts
  of `posture`, which each page draws for itself.
- `recorded_stream` exports a race as a `.viser` file; `update_cost` is the benchmark of one update.
- `viser_internals` has all that rests on viser's private parts, and the list of what is assumed.
"""
