"""Experiments over many seeds, as runs of the server and as commands.

`feature` declares it. On the command line (`commands`): `experiment_command`, `sweep_command` and
`tune_command`, with
`trial_options` (their options) and `command_trials` (trials with a progress bar).
"""
