"""Entry point of a worker process: builds what its task names, runs the loop, sends messages.

The process ends with its task, or with the server, however that ends.
"""

import logging
import os
import queue
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection

import numpy as np
from numpy.typing import NDArray

from app.events import logs
from app.jobs.job_control import InterruptibleAgent, JobControl, Stopped
from app.jobs.messages import (
    Began,
    Checkpointed,
    Command,
    Ended,
    Failed,
    Heartbeat,
    Message,
    RaceTask,
    Saved,
    Task,
    TrainingTask,
)
from hexapods.assembly import build_learner, build_walkers
from hexapods.domain.disturbance_documents import as_mapping, disturbance_from
from hexapods.domain.errors import HexapodError
from hexapods.runs.baseline import BASELINES
from hexapods.runs.racing import race
from hexapods.runs.records import Evaluated, LaneStep, StepTaken
from hexapods.runs.results import training_result
from hexapods.runs.tables import restore, snapshot, to_bytes
from hexapods.runs.training import Learner, train
from hexapods.runs.walker import SearchInterrupted, Walker

HEARTBEAT_EVERY_S = 1.0
_logger = logging.getLogger(__name__)


def main(pipe: Connection) -> None:
    """Run the task that is the first item in the pipe, then end the process."""
    logs.install("warning")
    task: Task = pipe.recv()
    commands: queue.SimpleQueue[Command] = queue.SimpleQueue()
    stopping = threading.Event()
    threading.Thread(target=_receive_commands, args=(pipe, commands, stopping), daemon=True).start()
    send = _one_at_a_time(pipe)
    threading.Thread(target=_send_heartbeats, args=(send,), daemon=True).start()
    control = JobControl(send, commands)
    try:
        if isinstance(task, TrainingTask):
            _train(task, control)
        elif isinstance(task, RaceTask):
            _race(task, control, stopping)
        else:
            task.run(control.send, commands)
    except HexapodError as error:
        control.send(Failed(str(error)))
    except Exception as error:
        _logger.exception("a job failed")
        control.send(Failed(f"something in it broke ({type(error).__name__}: {error})"))
    pipe.close()
    sys.stderr.flush()
    # Nothing is left to be done, and taking MuJoCo's threads down takes a while.
    os._exit(0)


def _train(task: TrainingTask, control: JobControl) -> None:
    config = task.config
    BASELINES.add(task.baselines)
    learner = build_learner(config, task.table, threads=0)
    walker, rest_qpos = learner.walker, _pose(learner.walker)
    control.keep_pace(config.pace, config.robot.step_s)
    changes = ()
    if task.checkpoint is not None:
        restore(learner, task.checkpoint)
        changes = task.checkpoint.meta["changes"]
    control.disturb = lambda document: as_mapping(
        learner.disturb(disturbance_from(document), config)
    )
    learner.logged, control.take_transitions = [], learner.take_transitions
    control.restore_changes(changes, task.changes, learner.step, walker.agent)
    control.send(Began((rest_qpos,), learner.step))
    control.checkpoint_regularly(lambda: Checkpointed(_saved(learner, task, control), learner.step))
    result, evaluated, changes_before = None, None, 0
    with suppress(Stopped):
        for record in train(_interruptible(learner, control), config, record=True):
            control.report(record, learner.step)
            if isinstance(record, StepTaken):
                if not control.wait_for_turn(learner.step, walker.agent):
                    raise Stopped
                evaluated, changes_before = None, len(control.changes)
            elif isinstance(record, Evaluated):
                evaluated = record
        control.flush()
        # A change during an evaluation may lead to another evaluation.
        is_current = len(control.changes) == changes_before
        result = training_result(learner, config, evaluated=evaluated if is_current else None)
    control.flush()
    if control.exiting and not control.stopped:
        control.checkpoint()
        return
    if result is None:
        # The table is stored even if the evaluation takes longer than a stop may.
        control.checkpoint()
        # The baseline's walk takes a while; a training that is stopped early does not wait for it.
        result = training_result(learner, config, measure_reference=False)
    control.send(Saved(_saved(learner, task, control)))
    control.send(Ended("stopped" if control.stopped else "finished", result))


def _saved(learner: Learner, task: TrainingTask, control: JobControl) -> bytes:
    return to_bytes(snapshot(learner, task.config, changes=control.changes))


def _interruptible(learner: Learner, control: JobControl) -> Learner:
    """Return the learner with evaluations that execute commands between two steps."""
    evaluator, baseline = learner.evaluator, learner.baseline

    def interruptible(walker: Walker) -> Walker:
        # Once it was stopped, what is left is the last evaluation.
        if not control.stopped:
            walker.agent = InterruptibleAgent(
                walker.agent, lambda: control.execute_pending(learner.step, learner.walker.agent)
            )
        return walker

    learner.evaluator = lambda world, rng: interruptible(evaluator(world, rng))
    learner.baseline = lambda world: interruptible(baseline(world))
    return learner


def _race(task: RaceTask, control: JobControl, stopping: threading.Event) -> None:
    def interrupt_if_stopping() -> None:
        if stopping.is_set():
            raise SearchInterrupted

    walkers = build_walkers(task.config, task.tables)
    for walker in walkers:
        walker.interrupt_by(interrupt_if_stopping)
    control.send(Began(tuple(_pose(walker) for walker in walkers)))
    done = 0
    try:
        for record in race(walkers, task.config.steps, time.perf_counter, task.prefix):
            done += isinstance(record, LaneStep)
            control.report(record, done)
            if not control.wait_for_turn(done):
                break
    except SearchInterrupted:
        control.wait_for_turn(done)  # executes the command that stops it
    control.flush()
    if not control.exiting:
        control.send(Ended("stopped" if control.stopped else "finished", None))


def _pose(walker: Walker) -> NDArray[np.float32]:
    return walker.simulator.pose(walker.state).astype(np.float32)


def _one_at_a_time(pipe: Connection) -> Callable[[Message | Heartbeat], None]:
    """Return a function that sends from any thread; a pipe itself is not thread-safe."""
    lock = threading.Lock()

    def send(message: Message | Heartbeat) -> None:
        with lock:
            pipe.send(message)

    return send


def _send_heartbeats(send: Callable[[Message | Heartbeat], None]) -> None:
    with suppress(OSError):  # the pipe is closed, so the process is about to end
        while True:
            send(Heartbeat())
            time.sleep(HEARTBEAT_EVERY_S)


def _receive_commands(
    pipe: Connection, commands: "queue.SimpleQueue[Command]", stopping: threading.Event
) -> None:
    """Queue commands from the pipe; exit when the server closes it or dies.

    Args:
        pipe: from the server.
        commands: the queue.
        stopping: set once a command to stop is in the queue.
    """
    try:
        while True:
            command: Command = pipe.recv()
            commands.put(command)
            if command.verb == "stop":
                stopping.set()
    except (EOFError, OSError):
        os._exit(1)
