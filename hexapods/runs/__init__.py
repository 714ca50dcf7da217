"""Training loop and race loop; independent of web, database and job processes.

- `config` has the walking problem and the validated configs of trainings, `lane` and `race_config`
  those of races.
- `training` is the training loop with its evaluations, `racing` the race loop; both yield
  `records`. `walker` combines a simulator, its current state and an agent. `seeding` spawns
  independent random generators from one seed.
- `catalogue` has names, titles, descriptions and limits, for the options and for reports.
- `clocks` computes decision and motion times of a race, `results` its distances, times and ranks.
- `recording` stores motion for playback; `stored_practice` encodes a training's recording as
  arrays, `race_file` a race's, by `step_arrays`; `step_figures` are figures of all steps as one
  array; `npz_slices` reads parts of a table's arrays. `recorded_walk` reads recordings of all
  kinds alike.
- `gait_analysis` computes footfalls, speed, cycle, posture and energy of a recorded walk,
  `footfall` when its feet are on the ground; `move_comparison` compares each step with the best.
- `presses` are those of people who watch a training, from which its agent learns.
- `transition_log` keeps what a learner observed, did and earned; `rebuilding` builds a learner
  again from it, at any step, and explains its steps.
- `tables` takes, restores, encodes and validates checkpoints; `table_file` reads a table from its
  file row by row.
- `preview` computes support, reach, states and speed before anything runs, `recommendation` which
  learner suits; `best_known` has the farthest walks that are known, by `beam_search`; `baseline`
  the distances of one-step look-ahead, by all that they depend on.

To add a setting of a training: an annotated field in `config`, and its name in the form
(`static/js/form.js`). To add one of a lane: an annotated field of `LaneConfig` in `lane`; requests,
`GET /options`, stored races, `hexapods.lane` and the command line follow.
"""
