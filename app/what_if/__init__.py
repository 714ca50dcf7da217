"""What-ifs: 30 kinematic trials with a form's settings beside 30 with the defaults, in a second.

`what_if` answers and caches; `trial_pool` keeps the processes that run the trials.
"""
