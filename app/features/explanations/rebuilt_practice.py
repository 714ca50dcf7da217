"""One walk whose learner can be built again at any step, forward and back, by snapshots."""

import time
from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any, Protocol

from app.storage.errors import Busy
from hexapods.domain.errors import HexapodError
from hexapods.runs.rebuilding import ExplainedStep, LearnerSnapshot, NotRebuilt, RebuiltLearner
from hexapods.runs.transition_log import Logged

SNAPSHOT_EVERY_S = 0.04
"""Computing time after which a snapshot is taken [s]; going a step back takes at most as long."""
MAX_SNAPSHOT_BYTES = 32_000_000
"""Limit on the memory of all snapshots of a walk; beyond it every second one is dropped."""
WORK_S = 1.5
"""Computing time for one request [s]; if it needs more, it is refused, and the next goes on."""
Changes = Sequence[Mapping[str, Any]]


class LoggedSteps(Protocol):
    """Steps of a walk, from its start."""

    def __len__(self) -> int:
        """Return the number of steps so far."""

    def step(self, number: int) -> Logged:
        """Return the step of an index, from 0 on."""


class RebuiltPractice:
    """A learner that can be moved to any step of its walk. Not thread-safe.

    It is given the steps with each call, since they take much more memory than the learner.
    """

    def __init__(self, new: Callable[[], RebuiltLearner]) -> None:
        """Create the learner as it was before the first step.

        Args:
            new: makes the learner as it was before the first step.
        """
        self._new, self._learner = new, new()
        self._changes: Changes = ()
        self._snapshots: list[LearnerSnapshot] = []
        self._spacing_s, self._worked_s = SNAPSHOT_EVERY_S, 0.0

    def fits(self, steps: LoggedSteps, changes: Changes) -> bool:
        """Whether the learner has taken no other steps and changes than the walk has now.

        A training that resumes may have forgotten steps, and changes of settings may follow.
        """
        reached = max(self._learner.step, *(snapshot.step for snapshot in self._snapshots[-1:]), 0)
        tuned = max(self._learner.tuned, *(snapshot.tuned for snapshot in self._snapshots[-1:]), 0)
        recorded_changes = self._changes[:tuned]
        return len(steps) >= reached and list(changes[: len(recorded_changes)]) == list(
            recorded_changes
        )

    def learner_at(self, step: int, steps: LoggedSteps, changes: Changes) -> RebuiltLearner:
        """Return the learner after so many steps; valid until the next call.

        Args:
            step: number of steps, up to the length of the walk.
            steps: the walk.
            changes: changes of settings during the walk, in order, each with its `step`.

        Raises:
            Busy: if it takes too long for one request; the next one goes on from there.
            NotRebuilt: if the learner does not do what it did in the walk.
        """
        self._changes = changes
        self._go_to(step, steps)
        return self._learner

    def explain(self, step: int, steps: LoggedSteps, changes: Changes) -> ExplainedStep:
        """Explain a step, counted from 1.

        Raises:
            Busy, NotRebuilt: as `learner_at`.
        """
        self._changes = changes
        if not (self._learner.step == step - 1 and self._learner.can_explain):
            # A learner that chooses early chooses in the step before.
            early = self._learner.chooses_early and step > 1
            self._go_to(step - 1 - early, steps)
            if early:
                self._take(steps, explain_next=True)
        self._tune()
        logged = steps.step(step - 1)
        with self._starting_anew_if_broken(step):
            explained = self._learner.explain(logged)
        if not logged.next_observation:
            # The newest step of a lane, from which it learns before the next one.
            self._learner, self._worked_s = self._new(), 0.0
        return explained

    def _go_to(self, step: int, steps: LoggedSteps) -> None:
        place = bisect_right(self._snapshots, step, key=lambda snapshot: snapshot.step) - 1
        nearest = self._snapshots[place] if place >= 0 else None
        if self._learner.step > step or (nearest and nearest.step > self._learner.step):
            self._learner, self._worked_s = self._new(), 0.0
            if nearest:
                self._learner.restore(nearest)
        began_s = time.perf_counter()
        while self._learner.step < step:
            taken_s = time.perf_counter()
            self._take(steps)
            now_s = time.perf_counter()
            self._worked_s += now_s - taken_s
            if self._worked_s > self._spacing_s:
                self._keep_snapshot()
            if now_s - began_s > WORK_S and self._learner.step < step:
                raise Busy(
                    f"the learner is built again from its first step on: {self._learner.step:,} of "
                    f"{step:,} steps are done; ask again",
                    1,
                )

    def _take(self, steps: LoggedSteps, explain_next: bool = False) -> None:
        self._tune()
        number = self._learner.step
        with self._starting_anew_if_broken(number + 1):
            self._learner.take(steps.step(number), explain_next=explain_next)

    @contextmanager
    def _starting_anew_if_broken(self, step: int) -> Iterator[None]:
        """Replace the learner by a new one if a step fails: half of the step may be done."""
        try:
            yield
        except Exception as error:  # a user-supplied agent may raise anything
            self._learner, self._worked_s = self._new(), 0.0
            if isinstance(error, HexapodError):
                raise
            raise NotRebuilt(
                f"step {step} cannot be explained: its agent failed when it was built again "
                f"({type(error).__name__}: {error})"
            ) from error

    def _tune(self) -> None:
        """Apply the changes of settings that were made after the steps so far."""
        learner = self._learner
        while learner.tuned < len(self._changes):
            change = self._changes[learner.tuned]
            if change["step"] > learner.step:
                break
            learner.tune(change)

    def _keep_snapshot(self) -> None:
        began_s, self._worked_s = time.perf_counter(), 0.0
        snapshot = self._learner.snapshot()
        if self._snapshots and snapshot.step <= self._snapshots[-1].step:
            return
        self._snapshots.append(snapshot)
        # Not much of the time for snapshots, which take long where tables are large.
        self._spacing_s = max(self._spacing_s, 5 * (time.perf_counter() - began_s))
        if sum(state.size for state in self._snapshots) > MAX_SNAPSHOT_BYTES:
            self._snapshots = self._snapshots[1::2]
            self._spacing_s *= 2
