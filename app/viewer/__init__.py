"""The 3D viewer: a viser server without a listener, relayed read-only to many browsers.

`hexapods.drawing` draws.

- `shared_stage` is a stage with all by which many watch it; `stage_loop` is its drawing thread.
- `viewer_page` has the routes of `/viewer/`.
- `hub` relays viser's stream to browsers, one `session` each; `snapshot` serves late joiners.
- `replay_frames` encodes the replays of stored runs, once for everybody.
- `update_cost` is the benchmark of one update.
"""
