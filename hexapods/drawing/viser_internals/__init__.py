"""Everything that rests on viser's internals, or on facts of the installed version.

Only this package imports viser's private modules or uses its private attributes; the rest of the
app draws with viser's public functions. `server` runs viser without a socket, `stream` decodes and
encodes what it sends, `recorder` keeps what is drawn, `batches` moves the instances of meshes,
`client` is its page in the browser, patched.

viser promises none of the following, so each is checked by the test of the same name in
`tests/drawing/viser_internals/test_assumptions.py`. If a new version breaks one, its test fails.

Assumed by `server`:

- server_class_is_replaceable: `ViserServer.__init__` looks up `viser.infra.WebsockServer` when it
  is called, and keeps the instance as `_websock_server` and its event loop as `_event_loop`.
- worker_owns_the_socket: `WebsockServer.start` runs `_background_worker(ready)` in a thread. It is
  the only place that listens, and sets `_background_event_loop`, `_stop_event` and
  `_broadcast_buffer`, on which the rest of the server works.
- producer_needs_only_send: `infra._infra._message_producer(websocket, buffer, client_id,
  backlog_done_message)` calls nothing of the websocket but `send(bytes)`, and ends when the
  buffer is `done`.
- backlog_precedes_its_marker: after `ViserServer._run_garbage_collector()` the producer sends the
  whole scene first, and then `_backlog_done_message`, a `ReplayDoneMessage`.
- tunnel_has_one_entrance: only `ViserServer.request_share_url` opens a public tunnel.
- prints_go_through_rich: viser writes to the console through `rich` only.
- closed_loops_wake_nothing: viser draws the same if the event loop of its message buffer is closed;
  of a server's thread it only uses `WebsockServer.start` and `stop`, and `_server_thread` if any.
- types_are_looked_up: a handle's `_prop_hints` is what `get_type_hints` of its module returns for
  the class of its properties, and only read.

Assumed by `stream`:

- frame_layout: see the docstring of `stream`; encoding a decoded frame gives the same bytes.
- arrays_are_referenced: a message names an array as `{"__binary_index": …, "dtype": …}`.
- version_is_the_subprotocol: the browser asks for the websocket subprotocol `viser-v<version>`.
- lifecycle_of_messages: message classes declare `entity_type`, `lifecycle_phase` and
  `entity_id_field`; the phases are create, update_dict, update_simple, remove and none.
- redundancy_of_messages: two messages are redundant for viser exactly if they are for `slot_of`.
- commands_to_the_browser: only the messages in `BLOCKED_TYPES` run scripts or ask for an answer.

Assumed by `recorder`:

- serializers_get_each_message: `queue_message` passes each message to every serializer in
  `_record_handles`, under `_record_lock`; a `StateSerializer` keeps them in `_messages`, with their
  arrays in `_binary_buffers`; `message_from_id` of the buffer is the whole scene.
- changes_of_an_array_are_plain: `as_serializable_dict` of a `SceneNodeUpdateMessage` of one array
  is its name, the array by its index, the owner and the type.

Assumed by `batches`:

- instances_are_properties: assigning `batched_positions` or `batched_wxyzs` of a mesh writes them
  into the array of that name in `_impl.props`, and calls `_queue_update` with the name and a copy.

Assumed by `client`:

- page_is_one_file: `viser/client/build/index.html` is the whole client, with one `<head>`.
- client_is_packed: the page has one script, which unpacks the client from base 88 and zstd.
- worker_messages: the websocket lives in a worker that takes `set_server`, `retry` and `send`, and
  reports `connected` and `closed`, with `versionMismatch` (for close code 1002) and `closeReason`;
  it closes an attempt to connect after five seconds.
- query_parameters: the client reads `websocket` and those of `ALLOWED_QUERY` of
  `app/viewer/viewer_page.py`.
- reconnects_with_focus: the client reconnects only while `document.hasFocus()`.
- code_from_strings: the client calls `Function` only for `RunJavascriptMessage`, which is blocked,
  and in the sorter of Gaussian splats, of which the stage has none.
- worker_connects: the client connects by posting `set_server` to its worker, takes `connected` for
  an empty scene, and shows it after a `message_batch` with `ReplayDoneMessage`, so that
  `static/viewer/offline.js` can do without a server.
- controls_have_these_selectors: `static/viewer/patch.css` hides viser's controls by attributes and
  class names of its page.
- labels_are_taken_out: the worker posts messages as `message_batch`, which the client reads after
  `static/viewer/labels.js` has emptied the labels in it, and pushes to `messageQueue` of
  `__viserMutable`, as the page does with what it draws by itself. There are also the camera, the
  canvas, the scene, of which `onAfterRender` is free, and the poses and objects of scene nodes by
  name. It is assigned to the window once, with its queue.
- clicks_go_through_the_worker: `SetSceneNodeClickBindingsMessage` makes a node clickable, by button
  and modifier; a click without a drag is sent through the worker as a `SceneNodeClickMessage`,
  with the number of the instance of a batched mesh, so that `static/viewer/clicks.js` can keep it.
- batched_colors_are_linear: colours of batched meshes are taken as linear, all others as sRGB.
"""
