"""`hexapods serve` as people run it: a process of its own, on loopback."""

import os
import signal
import subprocess
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

import httpx2
import psutil

from tests.event_streams import ReceivedEvent, open_stream
from tests.forked import HEXAPODS, start_hexapods
from tests.timeouts import LONG_S, ProgressTimeout

BODY = {"gait": "left-right-origin", "simulator": "kinematic"}
ENDLESS = {**BODY, "steps": 10_000_000, "pace": 20, "evaluate_every": 0}


def environ(**variables: str) -> dict[str, str]:
    """Return the environment of a server whose jobs have the priority of the tests."""
    inherited = {
        name: value for name, value in os.environ.items() if not name.startswith("HEXAPODS_")
    }
    return {**inherited, "HEXAPODS_JOB_NICENESS": "0", **variables}


class NotStartedError(Exception):
    """The server has ended instead of serving."""


class Served:
    """`hexapods serve` on a port that the system chose."""

    def __init__(
        self,
        data: Path,
        log: IO[str] | None = None,
        before: Sequence[str] = (),
        **variables: str,
    ) -> None:
        """Start it.

        Args:
            data: its folder.
            log: what its standard error goes to; None for that of the tests.
            before: what to put before its command.
            variables: of its environment.
        """
        command = ["serve", "--port", "0", "--data", str(data)]
        env = environ(**variables)
        self.process = (
            subprocess.Popen(
                [*before, *HEXAPODS, *command],
                stdout=subprocess.PIPE,
                stderr=log,
                text=True,
                env=env,
            )
            if before
            else start_hexapods(command, env, log)
        )
        assert self.process.stdout is not None
        line = self.process.stdout.readline()
        if "Racing Hexapods is at http://127.0.0.1:" not in line:
            self.process.stdout.close()
            raise NotStartedError(f"exit code {self.process.wait(LONG_S)}: {line}")
        self.address = line.split()[4].rstrip("/")
        # Reading the system's certificates takes longer than a request; nothing here needs them.
        self.client = httpx2.Client(
            base_url=self.address, timeout=LONG_S, trust_env=False, verify=False
        )

    def start(self, body: dict[str, Any], path: str = "/trainings") -> dict[str, Any]:
        response = self.client.post(f"/api/v1{path}", json=body)
        assert response.status_code == 202, response.text
        run: dict[str, Any] = response.json()
        return run

    def moving(self, run: dict[str, Any]) -> dict[str, Any]:
        return self.until(run, lambda now: now["progress"]["done"] > 0)

    def look(self, run: dict[str, Any]) -> dict[str, Any]:
        shown: dict[str, Any] = self.client.get(f"/api/v1/{run['kind']}s/{run['id']}").json()
        return shown

    def until(self, run: dict[str, Any], is_so: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
        """The run once it is as it should be, for as long as it gets on."""
        stall_check = ProgressTimeout()
        while not is_so(now := self.look(run)):
            stall_check.check(now)
            time.sleep(0.1)
        return now

    def after_step(self, run: dict[str, Any], step: int) -> dict[str, Any]:
        return self.until(run, lambda now: now["progress"]["done"] >= step)

    def in_state(self, run: dict[str, Any], *states: str) -> dict[str, Any]:
        return self.until(run, lambda now: now["state"] in states)

    def hurry(self, training_id: str) -> None:
        """Set the pace of a training to the maximum."""
        self.in_state({"kind": "training", "id": training_id}, "running")
        path = f"/api/v1/trainings/{training_id}"
        assert self.client.patch(path, json={"pace": "max"}).status_code == 200

    def tell(self, run: dict[str, Any], verb: str) -> httpx2.Response:
        return self.client.post(f"/api/v1/{run['kind']}s/{run['id']}/{verb}")

    def jobs(self) -> list[psutil.Process]:
        """The processes of its jobs."""
        family = psutil.Process(self.process.pid).children(recursive=True)
        return [process for process in family if is_job(process)]

    def events(self, query: str = "", last: str | None = None) -> Iterator[ReceivedEvent]:
        headers = {} if last is None else {"Last-Event-ID": last}
        with open_stream(self.client, f"/api/v1/events{query}", headers=headers) as stream:
            yield from stream.events

    def end(self, by: int = signal.SIGTERM) -> int:
        self.client.close()
        if self.process.poll() is None:
            self.process.send_signal(by)
        code = self.process.wait(LONG_S)
        assert self.process.stdout is not None
        self.process.stdout.close()
        return code


def is_job(process: psutil.Process) -> bool:
    """Whether it is that of a job, by its name; not so if it is gone, or about to be."""
    try:
        return process.name().startswith(("training ", "race ", "experiment "))
    except psutil.NoSuchProcess:
        return False


@contextmanager
def serving_from(data: Path) -> Iterator[Callable[..., Served]]:
    """Starts servers on a data folder, one after another; none outlives the test."""
    served: list[Served] = []

    def make(**options: Any) -> Served:
        served.append(Served(data, **options))
        return served[-1]

    try:
        yield make
    finally:
        for server in served:
            server.end(signal.SIGKILL)
