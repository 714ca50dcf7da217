"""The stage: plays one run's recording for all viewers, frame by frame. No drawing is done here.

- `stage` chooses the run that is shown and executes playback commands.
- `playback` makes a run's show, and a replay that is at any moment that a page asks for.
- `show` is the interface of playbacks; `race_show` plays a race, `practice_show` a training.
- `race_lane` plays one lane of a race; `timeline` gives a race over time for the page's chart.
- `stage_frame` is an immutable snapshot of one moment; `scene_spec` builds its constant part.
- `recording_export` streams a race's recording as JSON.
"""
