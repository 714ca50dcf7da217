"""Experiments as a feature."""

from app.feature import Feature


class Experiments(Feature):
    """Experiments over many seeds."""

    name = "experiments"


FEATURE = Experiments
