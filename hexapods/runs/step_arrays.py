"""Steps of a lane as arrays, as a file has them: packed, joined, and made when asked for."""

from collections.abc import Collection, Sequence
from itertools import accumulate
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hexapods.agents.explanation import Future
from hexapods.domain.simulator import Motion
from hexapods.domain.types import Action
from hexapods.runs.records import ActionValues, LaneStep
from hexapods.runs.step_figures import StepColumns

COLUMNS = ("scalars", "observation", "action", "frames", "values", "visits")
"""Arrays with a row for each step."""
FUTURES = ("future_actions", "future_values", "future_counts")
"""Arrays with a row for each action whose future a search has simulated."""
_SCALARS = ("reward_m", "distance_m", "transitions", "decision_s")


class StepArrays:
    """Steps of a lane as arrays: about 2.5 kB a step, half of what they take as objects."""

    def __init__(self, lane: int, arrays: dict[str, NDArray[Any]]) -> None:
        """Take the arrays of at least one step.

        Args:
            lane: number of the lane.
            arrays: arrays by name in a file, without the lane's: those of `COLUMNS`, the fields of
                `Motion` with a row for each frame, and `futures`, the numbers of rows of `FUTURES`.

        Raises:
            ValueError: if the lengths of the arrays do not fit together.
        """
        self._lane, self._arrays = lane, arrays
        if arrays["frames"].min() < 1:
            raise ValueError("a step has no frames")
        self._starts = [0, *accumulate(arrays["frames"].tolist())]
        self._futures = [0, *accumulate(arrays["futures"].tolist())] if "futures" in arrays else []
        count = len(arrays["frames"])
        lengths = dict.fromkeys(COLUMNS, count) | dict.fromkeys(Motion._fields, self._starts[-1])
        if self._futures:
            if arrays["futures"].min() < 0:
                raise ValueError("what its search found is of other steps")
            lengths |= {"futures": count} | dict.fromkeys(FUTURES, self._futures[-1])
        for name, array in arrays.items():
            if len(array) != lengths[name]:
                raise ValueError(f"its {name} are of other steps")

    def __len__(self) -> int:
        """Number of steps."""
        return len(self._arrays["frames"])

    @classmethod
    def packed(cls, lane: int, steps: Sequence[LaneStep]) -> "StepArrays":
        """Pack at least one step; action values are rounded to single precision."""
        arrays: dict[str, NDArray[Any]] = {
            "scalars": np.array([[getattr(step, name) for name in _SCALARS] for step in steps]),
            "observation": np.array([step.observation for step in steps]),
            "action": np.array([step.action for step in steps]),
            "frames": np.array([len(step.motion.time_s) for step in steps]),
        }
        for name in Motion._fields:
            columns = [getattr(step.motion, name) for step in steps]
            if all(column is not None for column in columns):
                arrays[name] = np.concatenate(columns)
        values = [step.action_values for step in steps if step.action_values]
        if values:
            arrays["values"] = np.array([v.values for v in values], np.float32)
            arrays["visits"] = np.array([v.visits for v in values], np.float32)
        futures = [future for step in steps for future in step.futures]
        if futures:
            arrays["futures"] = np.array([len(step.futures) for step in steps])
            arrays["future_actions"] = np.array([f.action for f in futures], np.uint8)
            arrays["future_values"] = np.array([(f.reward_m, f.return_m) for f in futures], float)
            arrays["future_counts"] = np.array([(f.sequences, f.steps) for f in futures], np.uint32)
        return cls(lane, arrays)

    @property
    def names(self) -> Collection[str]:
        """Names of the arrays."""
        return self._arrays.keys()

    def array(self, name: str) -> NDArray[Any]:
        """Return an array; of steps without futures those of none."""
        if name in self._arrays or name != "futures":
            return self._arrays[name]
        return np.zeros(len(self), self._arrays["frames"].dtype)

    @property
    def nbytes(self) -> int:
        """Size of the arrays."""
        return sum(array.nbytes for array in self._arrays.values())

    @property
    def columns(self) -> StepColumns:
        """The columns from which figures follow."""
        arrays = self._arrays
        return StepColumns(
            arrays["scalars"],
            arrays["observation"],
            arrays["action"],
            arrays["frames"],
            Motion(*(arrays.get(name) for name in Motion._fields)),  # type: ignore[arg-type]
            arrays.get("values"),
        )

    def step(self, index: int, before: int = 0) -> LaneStep:
        """Return the step of an index, from 0 on; `before` is the number of steps before these."""
        arrays = self._arrays
        reward, distance, transitions, decision = arrays["scalars"][index].tolist()
        action_values = None
        if "values" in arrays:
            values_and_visits = (arrays[name][index].astype(float) for name in ("values", "visits"))
            action_values = ActionValues(*values_and_visits)
        frames = slice(self._starts[index], self._starts[index + 1])
        motion = (arrays[name][frames] if name in arrays else None for name in Motion._fields)
        return LaneStep(
            self._lane,
            before + index + 1,
            tuple(arrays["observation"][index].tolist()),
            Action(*arrays["action"][index].tolist()),
            reward,
            distance,
            int(transitions),
            decision,
            Motion(*motion),  # type: ignore[arg-type]
            action_values,
            self._futures_of(index),
        )

    def _futures_of(self, index: int) -> tuple[Future, ...]:
        """Return the futures that a search simulated in a step, by the index of the step."""
        if not self._futures:
            return ()
        rows_of_step = slice(self._futures[index], self._futures[index + 1])
        rows = zip(*(self._arrays[name][rows_of_step].tolist() for name in FUTURES), strict=True)
        return tuple(Future(Action(*action), *values, *counts) for action, values, counts in rows)


def joined(blocks: Sequence[StepArrays], name: str) -> NDArray[Any]:
    """Return an array of consecutive blocks of steps as one; those without it are left out."""
    arrays = [block.array(name) for block in blocks if name in block.names or name == "futures"]
    return arrays[0] if len(arrays) == 1 else np.concatenate(arrays)
