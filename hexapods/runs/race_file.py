"""File of a race's recording: encode the steps of its lanes as arrays, and decode them.

About 2.5 kB a step.
"""

import json
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hexapods.files import DrainedBuffer
from hexapods.runs.recording import Arrays, LaneRecording, LaneSteps
from hexapods.runs.step_arrays import StepArrays, joined

META = "meta"
_FIXED_TIME = (1980, 1, 1, 0, 0, 0)


def race_arrays(lanes: Sequence[LaneRecording]) -> Arrays:
    """Encode a race's recording as arrays for a file."""
    return dict(_encoded(lanes))


def race_chunks(lanes: Sequence[LaneRecording]) -> Iterator[bytes]:
    """Yield the `.npz` file of `race_arrays` in chunks, of which each has at most one array.

    Args:
        lanes: the recording, to which nothing is added meanwhile.
    """
    buffer = DrainedBuffer()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_STORED) as archive:
        for name, array in _encoded(lanes):
            info = zipfile.ZipInfo(f"{name}.npy", _FIXED_TIME)
            with archive.open(info, "w", force_zip64=True) as member:
                np.lib.format.write_array(member, array, allow_pickle=False)
            yield buffer.drain()
    yield buffer.drain()


def _encoded(lanes: Sequence[LaneRecording]) -> Iterator[tuple[str, NDArray[Any]]]:
    for number, lane in enumerate(lanes):
        yield f"lane{number}.rest_qpos", lane.rest_qpos
        blocks = lane.steps.blocks(number)
        for name in dict.fromkeys(name for block in blocks for name in block.names):
            yield f"lane{number}.{name}", joined(blocks, name)
    meta = [{"agent": lane.agent, "failure": lane.failure} for lane in lanes]
    yield META, np.array(json.dumps(meta))


def race_recording(arrays: Mapping[str, NDArray[Any]]) -> list[LaneRecording]:
    """Decode the output of `race_arrays`.

    Raises:
        ValueError: if the arrays do not fit together. NumPy raises other exceptions for arrays of
            other types.
    """
    lanes = []
    for number, meta in enumerate(json.loads(str(arrays[META]))):
        key = f"lane{number}."
        columns = {
            name.removeprefix(key): array for name, array in arrays.items() if name.startswith(key)
        }
        rest_qpos = columns.pop("rest_qpos")
        steps = LaneSteps.read(StepArrays(number, columns)) if columns else LaneSteps()
        lanes.append(LaneRecording(meta["agent"], rest_qpos, steps, meta["failure"]))
    return lanes
