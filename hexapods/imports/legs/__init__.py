"""The legs in a compiled file: which they are, where they lead, and how they stand.

- `skeleton` finds the torso and the legs, `feet` their feet, and `closed_loops` those to which two
  chains lead; `joint_kinds` names their joints.
- `directions` tells forward, by the names of `sides`, and numbers the legs.
- `stance` finds how the robot stands, by the kinematics of `chain` and `reach`; `heights` how high
  it could; `balance` tells which groups of legs would let it topple.
"""
