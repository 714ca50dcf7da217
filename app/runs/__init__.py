"""The two loops, train and race, and what they need: clocks, recordings, checkpoints."""
