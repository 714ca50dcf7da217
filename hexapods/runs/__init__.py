"""Training loop and race loop; independent of web, database and job processes.

`config` has the walking problem and the validated configs of trainings, `lane` and `race_config`
those of races.
`training` is the training loop with its evaluations, `racing` the race loop; both yield `records`.
`walker` combines a simulator, its current state and an agent.
`recording` stores motion for playback; `stored_practice` encodes a training's recording as arrays.
`gait_analysis` computes footfalls, speed, cycle, posture and energy of a recorded walk, `footfall`
when its feet are on the ground.
`transition_log` keeps what a learner observed, did and earned; `rebuilding` builds a learner again
from it, at any step, and explains its steps.
`clocks` computes decision and motion times of a race, `results` its distances, times and ranks.
`tables` takes, restores, encodes and validates checkpoints; `table_file` reads a Q-table from its
file row by row.
`best_known` searches for the farthest walks, and has those that are kept.
`seeding` spawns independent random generators from one seed.
"""
