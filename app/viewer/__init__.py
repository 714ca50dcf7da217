"""The picture of runs: encoded once for everybody, pushed to pages, and fetched by them.

`hexapods.drawing` draws; pages play.

- `replay_frames` encodes frames of stored runs.
- `picture_feed` advances a stage, and pushes the frames that its playhead comes to.
- `shared_stage` is a stage with all by which many watch it.
- `viewer_page` has the routes of `/viewer/`: viser's client, in which a page draws.

A further stage is another `SharedStage` in the server's list of stages, entered by `async with`,
and taken from the list before its `close()` (`tests/stage/two_stages.py`). It has its own
playlist, channel on the bus, roles and path, below which are the page and all routes. Runs, queue,
limits and slots of streams belong to the server; a run that is started is offered to the first.
"""
