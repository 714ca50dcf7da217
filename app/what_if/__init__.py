"""Quick trials for the form: 30 kinematic seeds of its settings beside 30 of the defaults.

`what_if` answers and caches; `trial_pool` keeps the processes that run the trials.
"""
