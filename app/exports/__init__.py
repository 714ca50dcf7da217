"""A run's walk as files of other programs: tables, videos, logs of robots.

- `recorded_lanes`: the recorded steps of each robot of an ended race or training.
- `trajectory`: joint angles, feet and torques over time, as CSV and Parquet.
- `video`, `video_renderer`: MP4 and GIF, rendered off screen by MuJoCo.
- `mcap_log`: joint states and frames for tools of robots.
- `extras`: the optional packages that some files need.
"""
