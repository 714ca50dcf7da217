"""The 3D viewer: a viser server without a listener, relayed read-only to many browsers.

- `service` assembles the viewer and its routes; `stage_loop` is the drawing thread.
- `scene` draws a stage frame in viser: `track`, `robots`, `footgrid`, `ghosts`, `name_labels`.
- `robot_mesh` builds meshes from the MJCF; `shapes` and `colormap` are its primitives.
- `in_process` is viser without a socket; `wire` encodes and decodes its websocket frames.
- `hub` relays viser's stream to browsers, one `session` each; `snapshot` serves late joiners.
- `follow` decodes which robot a browser's camera follows.
- `client_page` serves viser's client with our patch; `client_policy` is its CSP.
- `protocol` sets uvicorn's websocket buffers; `recorded_stream` exports a race as a `.viser` file.
- `update_cost` is the benchmark of one update.
"""
