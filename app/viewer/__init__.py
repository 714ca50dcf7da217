"""The 3D viewer: a viser server without a listener, relayed read-only to many browsers.

`hexapods.drawing` draws.

- `service` assembles the viewer and its routes; `stage_loop` is the drawing thread.
- `hub` relays viser's stream to browsers, one `session` each; `snapshot` serves late joiners.
- `replay_frames` encodes the replays of stored runs, once for everybody.
- `update_cost` is the benchmark of one update.
"""
