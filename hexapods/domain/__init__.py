"""The walking problem: robots, gaits, kinematics and steps. NumPy only, no input or output.

- `types`: arrays, cells and actions; `errors`: the exception hierarchy; `text`: validation and
  escaping of names; `checks`: of numbers; `settings`: values that a user may choose; `records`:
  dataclasses as JSON.
- `robot`: morphology, servos and presets; `tolerance`: robots as they are built; `gait`:
  orientation and groups of legs; `grid`: the foot grid; `observation`: how the state is read, and
  the legal actions.
- `disturbances`: what can happen to a robot or the ground, by kind; `world`: all that happens in a
  run, and the conditions of each step; `terrain`: heights of the ground.
- `feet`: foot offsets and the kinematic law of a step; `legs`: the interface of legs, their joints
  and their kinematics; `kinematics`: the legs that there are; `motion`: servo commands of a step.
- `posture`: rotation and heading of a robot, and whether it has fallen.
- `simulator`: the simulator protocol; `kinematic`: the simulator without slip.
"""
