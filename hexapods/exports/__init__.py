"""Export a recorded walk as files for other programs: tables, videos, pages, robot logs.

- `registry`: all formats, each declared once with its function, from which routes, commands, menu
  and checks of extras follow.
- `export_format`: what the registry declares of a format, and what a format's function is given.
- `options`: settings of the formats.
- `recorded_walks`: the recorded steps of each robot, the source of most formats.
- `trajectory`: joint angles, feet and torques over time, as CSV and Parquet.
- `replay_page`: a page that replays a run without a server; `stage_picture`: a PNG of a moment of a
  run, drawn without OpenGL, for where that page may not play.
- `video`, `video_pictures`: MP4 and GIF, rendered off screen by MuJoCo; `sketch_picture`: a PNG of
  the robot in a file, before it is stored.
- `mcap_log`: joint states and frames for tools of robots.
- `recording_json`: a race's recording as JSON.
- `servo_map`, `servo_map_file`, `servo_walk`, `servo_files`: a walk as pulses of a real robot's
  servos. It needs a map of them, which no request has, so it is no format of the registry. To add a
  map: a file in `servo_maps`, named in `BUILT_IN_MAPS` of `servo_map`.
- `robot_files`: types of file that a robot is exported as. `robot_model`: MJCF, as `mjcf_text`
  writes it; `urdf`: URDF, with meshes in a zip; `exported_settings`: what both say to be read back;
  `xml_text`: numbers and names in XML.
"""
