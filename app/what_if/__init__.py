"""What-if service: estimates the effect of a form's settings by quick kinematic trials.

`what_if` runs 30 seeds with the chosen settings and 30 with the defaults, within a limit of time,
and caches results, in turns with operators first.
`estimate` times a few steps (`step_time`), and says from that how long a run would take.
"""
