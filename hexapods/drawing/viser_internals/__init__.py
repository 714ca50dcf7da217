"""Everything that rests on viser's internals, or on facts of the installed version.

Only this package imports viser's private modules or uses its private attributes; the rest of the
app draws with viser's public functions. `server` runs viser without a socket, `recorder` takes the
messages by which it draws, `messages` describes them, `batches` moves the instances of meshes,
`client` is its page in the browser, patched.

viser promises none of the following, so each is checked by the test of the same name in
`tests/drawing/viser_internals/test_assumptions.py`. If a new version breaks one, its test fails.

Assumed by `server`:

- server_class_is_replaceable: `ViserServer.__init__` looks up `viser.infra.WebsockServer` when it
  is called, and keeps the instance as `_websock_server` and its event loop as `_event_loop`.
- worker_owns_the_socket: `WebsockServer.start` runs `_background_worker(ready)` in a thread. It is
  the only place that listens, and sets `_background_event_loop`, `_stop_event` and
  `_broadcast_buffer`, of which drawing needs the first and the last.
- tunnel_has_one_entrance: only `ViserServer.request_share_url` opens a public tunnel.
- prints_go_through_rich: viser writes to the console through `rich` only.
- closed_loops_wake_nothing: viser draws the same if the event loop of its message buffer is closed;
  of a server's thread it only uses `WebsockServer.start` and `stop`, and `_server_thread` if any.
- types_are_looked_up: a handle's `_prop_hints` is what `get_type_hints` of its module returns for
  the class of its properties, and only read.

Assumed by `messages`:

- arrays_are_referenced: a message names an array as `{"__binary_index": …, "dtype": …}`.
- lifecycle_of_messages: message classes declare `entity_type`, `lifecycle_phase` and
  `entity_id_field`; the phases are create, update_dict, update_simple, remove and none.
- redundancy_of_messages: a message makes an earlier one redundant for viser exactly if both have
  the same slot, by the rule of `slotOf` in `static/js/replay-frames.js`.
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
- query_parameters: the client reads `websocket` and those of `ALLOWED_QUERY` of
  `app/viewer/viewer_page.py`.
- code_from_strings: the client calls `Function` only for `RunJavascriptMessage`, which is blocked,
  and in the sorter of Gaussian splats, of which the stage has none.
- worker_connects: the client connects by posting `set_server` to its worker, which opens no socket
  before; it takes `connected` for an empty scene, and shows it after a `message_batch` with
  `ReplayDoneMessage`, so that `static/viewer/client.js` can do without a server.
- controls_have_these_selectors: `static/viewer/patch.css` hides viser's controls by attributes and
  class names of its page.
- labels_are_taken_out: the client draws the messages in `messageQueue` of `__viserMutable`, to
  which it pushes those of its worker, and `static/viewer/labels.js` what the page draws, with
  empty labels. There are also the camera, the canvas, the scene, of which `onAfterRender` is free,
  and the poses and objects of scene nodes by name. It is assigned to the window once, with its
  queue.
- clicks_go_through_the_worker: `SetSceneNodeClickBindingsMessage` makes a node clickable, by button
  and modifier; a click without a drag is sent through the worker as a `SceneNodeClickMessage`,
  with the number of the instance of a batched mesh, so that `static/viewer/clicks.js` can keep it.
- camera_is_controlled: `cameraControl` of `__viserMutable` has the methods of `camera-controls` by
  which `static/viewer/inspection.js` puts the camera where a scene fills the picture, and
  `camera.js` hands it over. The scene's `onBeforeRender` is called when all nodes are where they
  will be drawn, and before the camera is read, so that `camera.js` places it there.
- keys_are_heard_on_the_document: the client moves its camera by arrows and by the letters in
  `MOVES` of `camera.js`, which it hears on the document, so that those can be kept from it.
- scene_is_prepared: the client itself has no `onBeforeRender` of the scene, by which also
  `static/viewer/light.js` changes lights and materials before each frame; the materials of grids
  have their colours as uniforms.
- glb_is_an_array: the data of a GLB may be an array of bytes, which is sent as such, and the
  client takes it; instances in a batch may have three scales each.
- batched_colors_are_linear: colours of batched meshes are taken as linear, all others as sRGB.
"""
