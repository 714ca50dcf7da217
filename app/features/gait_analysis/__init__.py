"""The gait analysis of a recorded walk: footfalls, speed, posture, torque and energy.

`feature` is what the core sees of it; `routes` has its route, with the answer.
"""
