"""What-ifs: many kinematic trials of a form's settings, answered while the slider is still warm."""
