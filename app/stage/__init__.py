"""The stage: the run that everyone is shown, and each moment of it as an immutable frame.

`stage` decides what is shown; `practice_show` and `race_show` play a training or a race from its
recording; `scene_spec` is what stands there before it begins, `stage_frame` one moment of it.
"""
