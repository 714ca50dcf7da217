"""The stage: plays one run's recording for all viewers. The shows are in `hexapods.shows`.

- `stage` chooses the run that is shown and executes playback commands; `state_machine` says what is
  on stage, and why.
- `recorded_runs` chooses what it shows by itself, after a start and as a replay.
- `planning` plans the playhead that pages follow; `stage_view` has the records that they get.
- `playback` makes the show of a stored run, and keeps replays.
- `roles` says who may operate a stage and who may watch it.
- `timeline` gives a race over time for the page's chart.

To add a phase: a row of `TRANSITIONS` in `state_machine`, and what the page says in it
(`static/js/narrative/narrative.js`).
"""
