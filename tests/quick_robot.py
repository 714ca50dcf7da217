"""A robot whose steps are so quick that MuJoCo takes a third of the time for them.

For tests that are about something else than how the default robot walks.
"""

from hexapods.domain.robot import robot

QUICK_STEPS = {"dt_s": 0.005, "swing_s": 0.05, "shift_s": 0.05}
HASTY = robot(QUICK_STEPS)
HASTY_JSON = {"preset": "stiff", **QUICK_STEPS}
"""`HASTY`, as it is given over REST."""
