"""The walking problem: robots, gaits, kinematics and steps. NumPy only, no input or output.

Values:
- `types`: arrays, cells and actions; `errors`: the exception hierarchy; `checks`: validation of
  numbers; `text`: of names; `sums`: sums of floats in one order; `short_repr`: short `repr`s.
- `settings`: values that a user may choose, each declared once; `records`: dataclasses as JSON.
- `plain_yaml`, `json_lists`: bounds for YAML and JSON from outside.
Robots:
- `robot`: presets, and a robot from what a request says of it; `body`: torso, legs, servos and step
  timing; `creatures`: those that are built in; `tolerance`: robots as they are built.
- `robot_model`: a robot from a file, as plain numbers; `model_robot`: the same as a `Robot`;
  `model_geometry`: its forward kinematics; `suggestions`: the foot grid with which it begins.
- `robot_documents`, `model_documents`: a stored robot by value; `robot_library`: where robots are
  found by their ids.
Gaits and steps:
- `gait`: orientation and groups of legs; `grid`: the foot grid; `observation`: how the state is
  read, and the legal actions.
- `feet`: foot offsets and the kinematic law of a step; `legs`: the interface of legs, their joints
  and their kinematics; `kinematics`, `chains`: the two kinds of legs, of three joints in closed
  form and of any hinges by `chain_solver`; `motion`: servo commands of a step.
- `posture`: rotation and heading of a robot, and whether it has fallen; `support`: its support
  margin.
- `disturbances`: what can happen to a robot or the ground, by kind; `disturbance_documents`: the
  same in JSON and on the command line; `world`: all that happens in a run, and the conditions of
  each step; `terrain`: heights of the ground.
- `simulator`: the simulator protocol; `kinematic`: the simulator without slip.

To add
- a robot: `CREATURES` in `creatures`, with a gait that suits it. A field of a robot: a field
  of `Robot` or `LegMount` in `body`, and its limits in `RANGES` or `PLACED_RANGES` of `robot`.
- a rule that groups legs: `Grouping` and `_GROUPINGS` in `gait`.
- a kind of legs: `Legs` and `FootKinematics` of `legs`, registered with `legs_of` and `robot_spec`.
- a kind of disturbance: a class in `disturbances`, which declares its fields; what it does to the
  model in `hexapods.physics.conditions`, or to commands and sensors in
  `hexapods.physics.mujoco_simulator` and `hexapods.runs.walker`; how it looks in
  `hexapods.drawing`. Requests, `GET /options`, the command line and the page follow.
- a named world: `WORLDS` in `world`; the page draws its picture from its disturbances.
- a simulator: the protocol in `simulator`, and a name in `hexapods.assembly`.
"""
