"""A job whose process is played by the test."""

import threading
from collections.abc import Callable
from unittest import mock

from app.events.bus import EventBus
from app.jobs.job import Job
from app.jobs.messages import Message, Task
from app.jobs.worker_process import WorkerProcess
from app.storage.database.store import RunStore
from app.storage.recordings import Recordings
from app.storage.run import Run


def played_job(
    run: Run, task: Task, store: RunStore, bus: EventBus
) -> tuple[Job, Callable[[Message], None]]:
    """Return a job whose process never starts, and what gives the job the process's messages.

    An outage of the database is not waited out.
    """
    handlers: list[Callable[[Message], None]] = []

    class NeverStarted(WorkerProcess):
        def __init__(
            self, name: str, task: Task, on_message: Callable[[Message], None], niceness: int
        ) -> None:
            super().__init__(name, task, on_message, niceness)
            handlers.append(on_message)

    shutdown = threading.Event()
    shutdown.set()
    with mock.patch("app.jobs.job.WorkerProcess", NeverStarted):
        job = Job(run, task, store, Recordings(store), bus, shutdown=shutdown, niceness=0)
    return job, handlers[0]
