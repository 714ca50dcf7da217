"""A job, in its own process: builds what the order names, runs the loop, and reports.

Ends when the job does or when the server does, however that ends.
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

from app.assembly import build_learner, build_walkers, finish_training
from app.domain.errors import HexapodError
from app.events import logs
from app.jobs.experiment_worker import experiment
from app.jobs.job_control import InterruptibleAgent, JobControl, Stopped
from app.jobs.messages import (
    Began,
    Checkpointed,
    Command,
    Ended,
    ExperimentTask,
    Failed,
    Heartbeat,
    Message,
    RaceTask,
    Saved,
    Task,
    TrainingTask,
)
from app.jobs.process_setup import set_up_process
from app.runs.racing import race
from app.runs.records import LaneStep, StepTaken
from app.runs.tables import restore, snapshot, to_bytes
from app.runs.training import Learner, train
from app.runs.walker import Walker

HEARTBEAT_EVERY_S = 1.0
_logger = logging.getLogger(__name__)


def main(pipe: Connection, niceness: int) -> None:
    """Work on the order that comes first through the pipe, and end the process."""
    set_up_process(niceness)
    logs.install("warning")
    order: Task = pipe.recv()
    words: queue.SimpleQueue[Command] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(pipe, words), daemon=True).start()
    send = _one_at_a_time(pipe)
    threading.Thread(target=_send_heartbeats, args=(send,), daemon=True).start()
    desk = JobControl(send, words)
    try:
        if isinstance(order, TrainingTask):
            _train(order, desk)
        elif isinstance(order, ExperimentTask):
            experiment(order, desk.send, words)
        else:
            _race(order, desk)
    except HexapodError as error:
        desk.send(Failed(str(error)))
    except Exception as error:
        _logger.exception("a job failed")
        desk.send(Failed(f"something in it broke ({type(error).__name__}: {error})"))
    pipe.close()
    sys.stderr.flush()
    # Nothing is left to be done, and taking MuJoCo's threads down takes a while.
    os._exit(0)


def _train(order: TrainingTask, desk: JobControl) -> None:
    config = order.config
    learner = build_learner(config, order.table, threads=0)
    walker, rest_qpos = learner.walker, _pose(learner.walker)
    desk.keep_pace(config.pace, config.robot.step_s)
    made = ()
    if order.checkpoint is not None:
        restore(learner, order.checkpoint)
        made = order.checkpoint.meta["changes"]
    desk.repeat(made, order.changes, learner.step, walker.agent)
    desk.send(Began((rest_qpos,), learner.step))
    desk.keep_safe(lambda: Checkpointed(_saved(learner, order, desk), learner.step))
    result = None
    with suppress(Stopped):
        for record in train(_attentive(learner, desk), config, record=True):
            desk.report(record, learner.step)
            if isinstance(record, StepTaken) and not desk.go_on(learner.step, walker.agent):
                raise Stopped
        desk.flush()
        result = finish_training(learner, config)
    desk.flush()
    if desk.leaving and not desk.stopped:
        desk.checkpoint()
        return
    if result is None:
        # The rival's walk is long; who stops a training early waits for nothing.
        result = finish_training(learner, config, measure_rival=False)
    desk.send(Saved(_saved(learner, order, desk)))
    desk.send(Ended("stopped" if desk.stopped else "finished", result))


def _saved(learner: Learner, order: TrainingTask, desk: JobControl) -> bytes:
    return to_bytes(snapshot(learner, order.config, changes=desk.changes))


def _attentive(learner: Learner, desk: JobControl) -> Learner:
    """The same learner, whose evaluations obey between two steps as its practice does."""
    evaluator, baseline = learner.evaluator, learner.baseline

    def listening(walker: Walker) -> Walker:
        # Once it was stopped, what is left is the last evaluation.
        if not desk.stopped:
            walker.agent = InterruptibleAgent(
                walker.agent, lambda: desk.listen(learner.step, learner.walker.agent)
            )
        return walker

    learner.evaluator = lambda rng: listening(evaluator(rng))
    learner.baseline = lambda: listening(baseline())
    return learner


def _race(order: RaceTask, desk: JobControl) -> None:
    walkers = build_walkers(order.config, order.tables)
    desk.send(Began(tuple(_pose(walker) for walker in walkers)))
    done = 0
    for record in race(walkers, order.config.steps, time.perf_counter):
        done += isinstance(record, LaneStep)
        desk.report(record, done)
        if not desk.go_on(done):
            break
    desk.flush()
    if not desk.leaving:
        desk.send(Ended("stopped" if desk.stopped else "finished", None))


def _pose(walker: Walker) -> NDArray[np.float32]:
    return walker.simulator.pose(walker.state).astype(np.float32)


def _one_at_a_time(pipe: Connection) -> Callable[[Message | Heartbeat], None]:
    """Send from several threads; a pipe by itself would mix what they send."""
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


def _listen(pipe: Connection, words: "queue.SimpleQueue[Command]") -> None:
    """Take in words until there is nobody to send any."""
    try:
        while True:
            words.put(pipe.recv())
    except (EOFError, OSError):
        os._exit(1)
