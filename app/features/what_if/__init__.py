"""What-ifs: the distances that settings would give, and the time that a run would take, in advance.

`what_if` runs 30 seeds with the chosen settings and 30 with the defaults on the kinematic
simulator, within a limit of time, and caches results, in turns with operators first; `allowance`
says how many a spectator may ask, which `settings` sets. `estimate`
times a few steps (`step_time`), and says from that how long a run would take. `feature` is what the
core sees of it; `routes`, with `response_models`, are both over REST.
"""
