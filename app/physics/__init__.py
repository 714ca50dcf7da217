"""The robot as MuJoCo computes it: from a `Robot` to a model, and the simulator on top."""
