"""Playback of recorded runs, frame by frame. No drawing is done here.

- `show` is the interface of playbacks; `race_show` plays a race, `practice_show` a training.
- `playhead` is the time that is shown, as a function of the server's clock.
- `replay` is a show at any moment that a page asks for, in segments of frames.
- `race_lane` plays one lane of a race.
- `stage_frame` is an immutable snapshot of one moment; `scene_spec` builds its constant part, and
  `scene_view` the record that pages get of it.
"""
