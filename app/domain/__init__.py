"""The walking problem itself: feet, gaits, legs, steps. NumPy only, no input or output."""
