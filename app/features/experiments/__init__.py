"""Experiments over many seeds, as a kind of run of the server and as commands.

- `feature` is what the core sees of it, and `run_kind` the kind of run as a value, which commands
  and processes see too.
- `start` validates what a user asks, and builds the run; `trial_runs` makes runs that repeat a
  trial.
- In the server: `job` takes the messages of an experiment's process. Between both: `messages`. In
  the process: `worker` runs the trials, in worker processes of its own
  (`hexapods.experiments.local_workers`), and sends results, summaries and the report.
- In the database: `tables`, with `trial_rows` and `migrations`; `stored_trials` decodes rows of
  trials, `archived_trials` validates those of an archive.
- Over REST: `routes`, `comparison_routes`, `request_bodies`, `response_models`; `options` are what
  forms need.
- On the command line (`commands`): `experiment_command` and `sweep_command`, with
  `trial_options` (their options) and `command_trials` (trials with a progress bar);
  `compare_command` and `figure_command`, which read a `stored_summary`.
"""
