"""Job control inside the worker process: send records, execute commands, keep the pace."""

import queue
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Literal

from app.jobs.messages import Batch, Changed, Checkpointed, Command, Message
from hexapods.agents.protocol import Agent, AgentState, Transition, Tunable
from hexapods.domain.errors import InvalidInput
from hexapods.domain.types import Action, Cells
from hexapods.runs.presses import apply_presses
from hexapods.runs.recording import NEWEST_STEPS
from hexapods.runs.records import RaceRecord, StepTaken, TrainingRecord
from hexapods.runs.transition_log import Transitions

BATCHES_PER_S = 30
CHECKPOINT_EVERY_S = 3.0
"""Period of checkpoints [s]. A crash loses the work since the last one: under 5 s, with one step
and a busy machine counted in."""


class Stopped(Exception):
    """Raised to abandon an evaluation when the job is to stop or to exit."""


class JobControl:
    """Connects a training or race loop to the server: batches records, executes commands.

    Attributes:
        stopped: whether a `stop` command arrived: end with the results so far.
        exiting: whether `checkpoint_and_exit` arrived: end with a checkpoint, to be resumed later.
        changes: changes of rates and pace, disturbances and presses during the run, each with the
            number of steps done.
        disturb: lets something happen to a training, given in plain types; returns it with the step
            in which it begins.
        take_transitions: returns the steps of practice since its last call, for the log.
    """

    def __init__(
        self, send: Callable[[Message], None], commands: "queue.SimpleQueue[Command]"
    ) -> None:
        """Create the control of one job.

        Args:
            send: sends a message to the server.
            commands: commands received from the server.
        """
        self.stopped = self.exiting = False
        self.changes: list[dict[str, Any]] = []
        self.disturb: Callable[[Mapping[str, Any]], Mapping[str, Any]] = _refuse
        self.take_transitions: Callable[[], Transitions | None] = lambda: None
        self.send = send
        self._commands = commands
        self._paused = False
        self._pace: float | Literal["max"] = "max"
        self._step_s = 0.0
        self._began_s = time.monotonic()
        """Scheduled begin of the present step [s]."""
        self._records: list[TrainingRecord | RaceRecord] = []
        self._done = 0
        self._sent_s = 0.0
        self._save: Callable[[], Checkpointed] | None = None
        self._saved_s = time.monotonic()
        self._saved: tuple[int, int] | None = None
        """Step and number of changes at the newest checkpoint."""
        self._to_replay: list[Mapping[str, Any]] = []
        self._deferred: list[Command] = []
        """Commands that came during an evaluation, to be executed after the next step."""

    def keep_pace(self, pace: float | Literal["max"], step_s: float) -> None:
        """Limit the speed to `pace` times real time; the first step begins now.

        Args:
            pace: times real time, or `max` for no limit.
            step_s: duration of one step of the robot [s].
        """
        self._pace, self._step_s = pace, step_s
        self._began_s = time.monotonic()

    def checkpoint_regularly(self, save: Callable[[], Checkpointed]) -> None:
        """Send a checkpoint every few seconds of progress, and before a long wait.

        Args:
            save: makes a checkpoint of the present state.
        """
        self._save = save

    def checkpoint(self) -> None:
        """Send a checkpoint now, after the records that precede it."""
        if self._save is not None:
            self.flush()
            self.send(self._save())
            self._saved_s = time.monotonic()

    def restore_changes(
        self,
        included: Iterable[Mapping[str, Any]],
        later: Iterable[Mapping[str, Any]],
        step: int,
        agent: object,
    ) -> None:
        """Restore the changes of a resumed run, and schedule the later ones for replay.

        Args:
            included: changes that the checkpoint includes.
            later: changes made after the checkpoint, to be replayed after the same steps.
            step: number of steps done.
            agent: the learner whose rates may be changed.
        """
        self.changes = [dict(change) for change in included]
        for change in self.changes:
            if "pace" in change:
                self._pace = change["pace"]
        self._to_replay = list(later)
        self._saved = (step, len(self.changes))
        self._replay_due(step, agent)

    def report(self, record: TrainingRecord | RaceRecord, done: int) -> None:
        """Buffer a record and send the buffer, at most `BATCHES_PER_S` times a second.

        Args:
            record: what happened.
            done: number of steps done, of all lanes together.
        """
        self._records.append(record)
        self._done = done
        if time.monotonic() - self._sent_s >= 1 / BATCHES_PER_S:
            self.flush()

    def flush(self) -> None:
        """Send the buffered records."""
        if self._records:
            records = _without_dropped_steps(self._records)
            self.send(Batch(records, self._done, self.take_transitions()))
        self._records = []
        self._sent_s = time.monotonic()

    def wait_for_turn(self, step: int, agent: object = None) -> bool:
        """Execute pending commands, and wait until the next step is due.

        Args:
            step: number of steps done.
            agent: the learner whose rates may be changed.

        Returns:
            False if the job is to stop or to exit.
        """
        self._replay_due(step, agent)
        deferred, self._deferred = self._deferred, []
        for command in deferred:
            self._execute(command, step, agent)
        while True:
            wait_s = self._wait_s()
            if wait_s is None or wait_s > 1 / BATCHES_PER_S:
                self.flush()
            self._checkpoint_if_due(step, wait_s)
            try:
                command = self._next_command(wait_s)
            except queue.Empty:
                self._begin_step()
                return True
            self._execute(command, step, agent)
            if self.stopped or self.exiting:
                return False

    def execute_pending(self, step: int, agent: object) -> None:
        """Execute pending commands during an evaluation, which has no pace.

        Args:
            step: number of steps done.
            agent: the learner whose rates may be changed.

        Raises:
            Stopped: if the job is to stop or to exit.
        """
        while not (self.stopped or self.exiting):
            wait_s = None if self._paused else 0.0
            self._checkpoint_if_due(step, wait_s)
            try:
                command = self._next_command(wait_s)
            except queue.Empty:
                return
            if "presses" in command.changes:
                # They change the table that is evaluated; repeated, they come before or after it.
                self._deferred.append(command)
                continue
            self._execute(command, step, agent)
            if self._paused:
                self.flush()
        raise Stopped

    def _checkpoint_if_due(self, step: int, wait_s: float | None) -> None:
        """Send a checkpoint if there is progress and the period would pass during the wait."""
        state = (step, len(self.changes))
        if self._save is None or state == self._saved:
            return
        due_s = self._saved_s + CHECKPOINT_EVERY_S
        if wait_s is None or time.monotonic() + wait_s >= due_s:
            self.checkpoint()
            self._saved = state

    def _next_command(self, wait_s: float | None) -> Command:
        if wait_s is not None and wait_s <= 0:
            return self._commands.get_nowait()
        return self._commands.get(timeout=wait_s)

    def _wait_s(self) -> float | None:
        """Return the time until the next step is due [s]; None while paused."""
        if self._paused:
            return None
        return self._began_s + self._interval_s() - time.monotonic()

    def _interval_s(self) -> float:
        return 0.0 if self._pace == "max" else self._step_s / self._pace

    def _begin_step(self) -> None:
        # From the scheduled start, since the time to compute steps would add up to a drift.
        due_s = self._began_s + self._interval_s()
        self._began_s = max(due_s, time.monotonic() - self._interval_s())

    def _execute(self, command: Command, step: int, agent: object) -> None:
        if command.verb == "stop":
            self.stopped = True
        elif command.verb == "checkpoint_and_exit":
            self.exiting = True
        elif command.verb == "tune":
            self._tune(command, step, agent)
        else:
            self._paused = command.verb == "pause"
            self._began_s = time.monotonic() - self._interval_s()  # the next step begins now

    def _tune(self, command: Command, step: int, agent: object) -> None:
        if time.monotonic() > command.expires_s:
            return  # its sender has reported a timeout, so that nothing may change
        try:
            self._apply(command.changes, step, agent)
        except InvalidInput as error:  # it fitted when the server checked it, some steps ago
            self.send(Changed(command.token, step, {}, str(error)))
            return
        changes = {name: value for name, value in self.changes[-1].items() if name != "step"}
        self.send(Changed(command.token, step, changes))

    def _replay_due(self, step: int, agent: object) -> None:
        while self._to_replay and self._to_replay[0]["step"] <= step:
            change = dict(self._to_replay.pop(0))
            self._apply({k: v for k, v in change.items() if k != "step"}, step, agent)

    def _apply(self, changes: Mapping[str, Any], step: int, agent: object) -> None:
        if "disturbance" in changes:
            changes = {**changes, "disturbance": self.disturb(changes["disturbance"])}
        if "settings" in changes and isinstance(agent, Tunable):
            agent.tune(**changes["settings"])
        apply_presses(agent, changes.get("presses", ()))
        if "pace" in changes:
            self._pace = changes["pace"]
            # A step that is overdue by the new pace begins now; those after it wait their time.
            self._began_s = max(self._began_s, time.monotonic() - self._interval_s())
        self.changes.append({"step": step, **changes})


def _refuse(disturbance: Mapping[str, Any]) -> Mapping[str, Any]:
    raise InvalidInput(f"{disturbance['kind']} can only happen to a training")


def _without_dropped_steps(
    records: list[TrainingRecord | RaceRecord],
) -> tuple[TrainingRecord | RaceRecord, ...]:
    """Leave out steps of practice that the recording's ring buffer would drop at once."""
    if len(records) <= NEWEST_STEPS:
        return tuple(records)
    early = (r for r in records[:-NEWEST_STEPS] if not isinstance(r, StepTaken))
    return (*early, *records[-NEWEST_STEPS:])


class InterruptibleAgent:
    """Wrapper of an `Agent` that executes commands before each action of an evaluation.

    Args:
        agent: the wrapped agent.
        listen: executes pending commands; raises `Stopped` to abandon the evaluation.
    """

    def __init__(self, agent: Agent, listen: Callable[[], None]) -> None:
        self._agent, self._listen = agent, listen

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        """Execute pending commands, then return the wrapped agent's action."""
        self._listen()
        return self._agent.act(observation, legal)

    def learn(self, transition: Transition) -> None:
        """Pass the transition to the wrapped agent."""
        self._agent.learn(transition)

    def state(self) -> AgentState:
        """Return the wrapped agent's state."""
        return self._agent.state()

    def load(self, state: AgentState) -> None:
        """Load a state into the wrapped agent."""
        self._agent.load(state)
