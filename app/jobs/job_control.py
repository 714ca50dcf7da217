"""What a job's process does between two steps: report, obey, and keep its pace."""

import queue
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Literal

from app.agents.protocol import Agent, AgentState, Transition, Tunable
from app.domain.types import Action, Cells
from app.jobs.messages import Batch, Changed, Checkpointed, Command, Message
from app.runs.recording import NEWEST_STEPS
from app.runs.records import RaceRecord, StepTaken, TrainingRecord

BATCHES_PER_S = 30
CHECKPOINT_EVERY_S = 3.0
"""A dead server loses what came after the last one: with a step and a busy machine under 5 s."""


class Stopped(Exception):
    """The job was told to stop, in the middle of something that is not worth finishing."""


class JobControl:
    """Stands between a loop and the server.

    Attributes:
        stopped: whether the job was told to stop.
        leaving: whether it was told to leave off, to go on another time.
        changes: what was changed while it ran, each with the steps that were done before.
    """

    def __init__(
        self, send: Callable[[Message], None], words: "queue.SimpleQueue[Command]"
    ) -> None:
        self.stopped = self.leaving = False
        self.changes: list[dict[str, Any]] = []
        self.send = send
        self._words = words
        self._paused = False
        self._pace: float | Literal["max"] = "max"
        self._step_s = 0.0
        self._due_s = time.monotonic()
        self._records: list[TrainingRecord | RaceRecord] = []
        self._done = 0
        self._sent_s = 0.0
        self._save: Callable[[], Checkpointed] | None = None
        self._saved_s = time.monotonic()
        self._saved: tuple[int, int] | None = None
        """The step and the number of changes of the newest checkpoint."""
        self._to_repeat: list[Mapping[str, Any]] = []

    def keep_pace(self, pace: float | Literal["max"], step_s: float) -> None:
        """Let a step take as long as it would at `pace` times real time."""
        self._pace, self._step_s = pace, step_s
        self._due_s = time.monotonic()

    def keep_safe(self, save: Callable[[], Checkpointed]) -> None:
        """Send a checkpoint every few seconds in which something happened, and before a wait."""
        self._save = save

    def checkpoint(self) -> None:
        """Send one now, after all that came before it."""
        if self._save is not None:
            self.flush()
            self.send(self._save())
            self._saved_s = time.monotonic()

    def repeat(
        self,
        made: Iterable[Mapping[str, Any]],
        later: Iterable[Mapping[str, Any]],
        step: int,
        agent: object,
    ) -> None:
        """Go on where someone else left off.

        Args:
            made: changes that are in force.
            later: changes that were made afterwards, to be made again after the same steps.
            step: how many steps are done.
            agent: whose rates may be changed.
        """
        self.changes = [dict(change) for change in made]
        for change in self.changes:
            if "pace" in change:
                self.keep_pace(change["pace"], self._step_s)
        self._to_repeat = list(later)
        self._saved = (step, len(self.changes))
        self._repeat(step, agent)

    def report(self, record: TrainingRecord | RaceRecord, done: int) -> None:
        """Send a record, together with others if they come fast."""
        self._records.append(record)
        self._done = done
        if time.monotonic() - self._sent_s >= 1 / BATCHES_PER_S:
            self.flush()

    def flush(self) -> None:
        """Send what was not sent yet."""
        if self._records:
            self.send(Batch(_worth_sending(self._records), self._done))
        self._records = []
        self._sent_s = time.monotonic()

    def go_on(self, step: int, agent: object = None) -> bool:
        """Obey what there is to obey, and wait until the next step is due.

        Args:
            step: how many steps are done.
            agent: whose rates may be changed.

        Returns:
            False if the job is to stop, or to leave off.
        """
        self._repeat(step, agent)
        while True:
            wait_s = self._wait_s()
            if wait_s is None or wait_s > 1 / BATCHES_PER_S:
                self.flush()
            self._checkpoint_if_due(step, wait_s)
            try:
                word = self._next_word(wait_s)
            except queue.Empty:
                self._set_due()
                return True
            self._obey(word, step, agent)
            if self.stopped or self.leaving:
                return False

    def listen(self, step: int, agent: object) -> None:
        """Obey what there is to obey in the middle of an evaluation, which has no pace.

        Raises:
            Stopped: if the job is to stop, or to leave off.
        """
        while not (self.stopped or self.leaving):
            wait_s = None if self._paused else 0.0
            self._checkpoint_if_due(step, wait_s)
            try:
                word = self._next_word(wait_s)
            except queue.Empty:
                return
            self._obey(word, step, agent)
            if self._paused:
                self.flush()
        raise Stopped

    def _checkpoint_if_due(self, step: int, wait_s: float | None) -> None:
        """If there is something new, and the next chance would come too late."""
        state = (step, len(self.changes))
        if self._save is None or state == self._saved:
            return
        due_s = self._saved_s + CHECKPOINT_EVERY_S
        if wait_s is None or time.monotonic() + wait_s >= due_s:
            self.checkpoint()
            self._saved = state

    def _next_word(self, wait_s: float | None) -> Command:
        if wait_s is not None and wait_s <= 0:
            return self._words.get_nowait()
        return self._words.get(timeout=wait_s)

    def _wait_s(self) -> float | None:
        """Until the next step is due; None for as long as it is paused."""
        if self._paused:
            return None
        return 0.0 if self._pace == "max" else self._due_s - time.monotonic()

    def _set_due(self) -> None:
        """The next step begins now; when the one after it is due follows from that."""
        if self._pace != "max":
            # From when it was due, or the time that a step takes to compute would add up.
            began = max(self._due_s, time.monotonic() - self._step_s / self._pace)
            self._due_s = began + self._step_s / self._pace

    def _obey(self, word: Command, step: int, agent: object) -> None:
        if word.verb == "stop":
            self.stopped = True
        elif word.verb == "leave":
            self.leaving = True
        elif word.verb == "tune":
            self._tune(word, step, agent)
        else:
            self._paused = word.verb == "pause"
            self._due_s = time.monotonic()

    def _tune(self, word: Command, step: int, agent: object) -> None:
        if time.monotonic() > word.expires_s:
            return  # its sender was told that nothing was changed
        self._change(word.changes, step, agent)
        self.send(Changed(word.token, step, dict(word.changes)))

    def _repeat(self, step: int, agent: object) -> None:
        while self._to_repeat and self._to_repeat[0]["step"] <= step:
            change = dict(self._to_repeat.pop(0))
            self._change({k: v for k, v in change.items() if k != "step"}, step, agent)

    def _change(self, changes: Mapping[str, Any], step: int, agent: object) -> None:
        rates = {name: value for name, value in changes.items() if name != "pace"}
        if rates and isinstance(agent, Tunable):
            agent.tune(**rates)
        if "pace" in changes:
            self.keep_pace(changes["pace"], self._step_s)
        self.changes.append({"step": step, **changes})


def _worth_sending(
    records: list[TrainingRecord | RaceRecord],
) -> tuple[TrainingRecord | RaceRecord, ...]:
    """All but those steps of practice that the recording would drop in the same moment."""
    if len(records) <= NEWEST_STEPS:
        return tuple(records)
    early = (r for r in records[:-NEWEST_STEPS] if not isinstance(r, StepTaken))
    return (*early, *records[-NEWEST_STEPS:])


class InterruptibleAgent:
    """Implements `Agent` by another one, and calls `listen` before it acts."""

    def __init__(self, agent: Agent, listen: Callable[[], None]) -> None:
        self._agent, self._listen = agent, listen

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        """Listen, then act."""
        self._listen()
        return self._agent.act(observation, legal)

    def learn(self, transition: Transition) -> None:
        """As the other does."""
        self._agent.learn(transition)

    def state(self) -> AgentState:
        """Of the other."""
        return self._agent.state()

    def load(self, state: AgentState) -> None:
        """Into the other."""
        self._agent.load(state)
