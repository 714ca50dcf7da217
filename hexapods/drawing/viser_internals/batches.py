"""Moves the instances of batched meshes, of which each frame has many."""

from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray


def move_instances(
    batch: viser.BatchedMeshHandle, name: str, values: NDArray[np.floating[Any]]
) -> None:
    """Assign `batched_positions` or `batched_wxyzs` of a mesh.

    Other than an assignment it compares nothing, and takes a fraction of the time.

    Args:
        batch: the mesh.
        name: of the property.
        values: float32, as many as before; they must not be changed afterwards.
    """
    getattr(batch._impl.props, name)[:] = values
    batch._queue_update(name, values)
