"""The 3D viewer: a viser server without a listener, relayed read-only to many browsers.

`hexapods.drawing` draws.

- `shared_stage` is a stage with all by which many watch it; `stage_loop` is its drawing thread.
- `viewer_page` has the routes of `/viewer/`.
- `hub` relays viser's stream to browsers, one `session` each; `snapshot` serves late joiners.
- `replay_frames` encodes the replays of stored runs, once for everybody.
- `update_cost` is the benchmark of one update.

A further stage is another `SharedStage` in the server's list of stages, entered by `async with`,
and taken from the list before its `close()` (`tests/stage/two_stages.py`). It has its own
playlist, channel on the bus, roles and path, below which are the page and all routes. Runs, queue,
limits and slots for viewers belong to the server; a run that is started is offered to the first.
"""
