"""What-if service: estimates the effect of a form's settings by quick kinematic trials.

`what_if` runs 30 seeds with the chosen settings and 30 with the defaults, limits the number of
waiting requests, and caches results.
`estimate` times a few steps (`step_time`), and says from that how long a run would take.
"""
