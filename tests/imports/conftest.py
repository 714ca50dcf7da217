"""A fixture that spares the tests most of the time of reading a robot."""

import pickle
from collections.abc import Iterator

import numpy as np
import pytest

from hexapods.imports.legs import stance


@pytest.fixture(scope="package", autouse=True)
def each_stance_is_searched_once() -> Iterator[None]:
    """Keep what a search for a stance finds: for the same legs it is always the same.

    Most tests read the same robot with another detail, and the search takes nearly all the time.
    """
    search, stances = stance.search, dict[bytes, list[np.ndarray]]()

    def kept_search(robot: stance.RobotWithLegs) -> stance.Angles:
        key = pickle.dumps(robot)
        if key not in stances:
            stances[key] = search(robot)
        return [angles.copy() for angles in stances[key]]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(stance, "search", kept_search)
        yield
