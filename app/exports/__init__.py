"""Export a run's walk as files for other programs: tables, videos, robot logs.

- `recorded_lanes`: the recorded steps of each robot of an ended race or training.
- `trajectory`: joint angles, feet and torques over time, as CSV and Parquet.
- `video`, `video_renderer`: MP4 and GIF, rendered off screen by MuJoCo.
- `mcap_log`: joint states and frames for tools of robots.
- `recording_json`: a race's recording as streamed JSON.
- `extras`: the optional packages that some files need.
"""
