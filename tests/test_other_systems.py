"""The server, its processes and its connections, with what Python lacks on Windows taken away.

`tests/as_windows` says what. This is not Windows: files, consoles and the system's own calls are
those of this machine.
"""

import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import closing
from http.client import HTTPConnection
from pathlib import Path
from typing import Any

import psutil
import pytest

from tests.imports.robots import bug
from tests.served import BODY, ENDLESS, Served, serving_from
from tests.timeouts import LONG_S

pytestmark = pytest.mark.promises

AS_WINDOWS = Path(__file__).parent / "as_windows"
BELOW_NORMAL = 15
"""Nice value that stands here for the class of Windows."""
LOAD = "import sys, hexapods as hx; print(len(hx.load_robot('bug.urdf').legs))"
SWEEP = {**BODY, "experiment": "sweep", "seeds": 3, "steps": 5, "workers": 2}
SWEEP["gaits"] = [SWEEP.pop("gait")]


def environment(log: Path) -> dict[str, str]:
    """Return variables for processes as on Windows, each of which writes its id to a file."""
    checkout = str(AS_WINDOWS.parents[1])
    return {"PYTHONPATH": f"{AS_WINDOWS}:{checkout}", "AS_WINDOWS": str(log)}


@pytest.fixture
def log(tmp_path: Path) -> Path:
    return tmp_path / "as_windows.log"


@pytest.fixture
def launch(tmp_path: Path, log: Path) -> Iterator[Callable[..., Served]]:
    with serving_from(tmp_path / "data") as make:

        def launch_as_windows(**variables: str) -> Served:
            # A program before the command keeps it from being forked from these tests.
            return make(before=("env",), **environment(log), **variables)

        yield launch_as_windows


def finished(server: Served, run: dict[str, Any]) -> dict[str, Any]:
    ended = server.in_state(run, "finished", "failed")
    assert ended["state"] == "finished", ended
    return ended


def test_it_trains_and_races(launch: Callable[..., Served]) -> None:
    server = launch()
    training = finished(server, server.start({**BODY, "steps": 20}))
    lanes = [{"agent": "q-learning", "training_id": training["id"]}, {"agent": "greedy"}]
    body = {"gait": "left-right-origin", "lanes": lanes, "steps": 3}
    race = finished(server, server.start(body, "/races"))
    assert len(race["result"]["lanes"]) == 2


def test_its_jobs_are_processes_of_their_own_and_end_with_it(
    launch: Callable[..., Served], log: Path
) -> None:
    server = launch(HEXAPODS_JOB_NICENESS="5")
    stopped, run = server.start(ENDLESS), server.start(ENDLESS)
    server.moving(stopped)
    assert server.tell(stopped, "stop").status_code == 202
    server.in_state(stopped, "stopped")

    server.moving(run)
    children = psutil.Process(server.process.pid).children()
    # The job that was stopped may have ended without having been waited for.
    running = [child for child in children if child.status() != psutil.STATUS_ZOMBIE]
    [job] = [child for child in running if "spawn_main" in " ".join(child.cmdline())]
    assert str(job.pid) in log.read_text().split()
    assert job.nice() == BELOW_NORMAL
    server.process.send_signal(signal.SIGKILL)
    psutil.wait_procs([job], timeout=LONG_S)
    assert not job.is_running()


def test_a_job_with_processes_of_its_own_is_killed_with_them(
    launch: Callable[..., Served],
) -> None:
    server = launch()
    finished(server, server.start(SWEEP, "/experiments"))
    run = server.start({**SWEEP, "seeds": 200, "steps": 500}, "/experiments")
    server.moving(run)
    family = psutil.Process(server.process.pid).children(recursive=True)
    workers = [process for process in family if process.ppid() != server.process.pid]
    assert len(workers) >= 2
    assert server.tell(run, "stop").status_code == 202
    server.in_state(run, "stopped")
    psutil.wait_procs(workers, timeout=LONG_S)
    assert not any(worker.is_running() for worker in workers)


def test_it_limits_connections_that_the_event_loop_accepts(launch: Callable[..., Served]) -> None:
    server = launch(HEXAPODS_MAX_CONNECTIONS_PER_ADDRESS="2")
    server.client.close()
    address = ("127.0.0.1", int(server.address.rpartition(":")[2]))

    def connected() -> HTTPConnection:
        connection = HTTPConnection(*address, timeout=LONG_S)
        connection.request("GET", "/healthz")
        assert connection.getresponse().read()
        return connection

    with closing(connected()) as first, closing(connected()), closing(connected()):
        assert first.sock.recv(1) == b"", "the one that was idle for longest makes room"


def test_a_robot_is_read_in_a_process_of_its_own(tmp_path: Path, log: Path) -> None:
    (tmp_path / "bug.urdf").write_text(bug())
    done = subprocess.run(
        [sys.executable, "-c", LOAD],
        cwd=tmp_path,
        env=environment(log),
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout) == (0, "6\n"), done.stderr
    assert len(log.read_text().split()) >= 2
