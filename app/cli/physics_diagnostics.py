"""Physics check of `hexapods doctor`, run in a subprocess: ten steps in MuJoCo, timed."""

import time

import numpy as np

from app.domain.observation import legal_actions, observe
from app.physics.mujoco_simulator import MujocoSimulator
from app.runs.config import WalkingProblem

STEPS = 10


def main() -> None:
    """Simulate the steps and print the rate; an exception is reported as the check's failure."""
    walk = WalkingProblem(gait="left-right-origin")
    simulator = MujocoSimulator(walk.robot, walk.resolved_gait, walk.grid)
    state, began = simulator.rest(), time.perf_counter()
    for number in range(STEPS):
        legal = legal_actions(observe(simulator, state, "measured"), len(walk.grid))
        state = simulator.step(state, legal[number % len(legal)]).state
    elapsed_s = time.perf_counter() - began
    if not np.isfinite(state.row).all():
        raise ValueError("the physics left the finite numbers")
    print(f"MuJoCo walks {STEPS / elapsed_s:,.0f} steps a second on one core")


if __name__ == "__main__":
    main()
