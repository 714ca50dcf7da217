"""The fork server: jobs are its forks, share what it has imported, and end with the server."""

import signal
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

import psutil
import pytest

from tests.served import BODY, ENDLESS, Served, serving_from
from tests.timeouts import LONG_S

pytestmark = pytest.mark.promises

SWEEP = {
    "experiment": "sweep",
    "simulator": "kinematic",
    "gaits": ["left-right-origin"],
    "seeds": 20,
    "steps": 50,
    "workers": 1,
}


@pytest.fixture
def launch(tmp_path: Path) -> Iterator[Callable[..., Served]]:
    with serving_from(tmp_path) as make:
        yield make


def fork_server(server: Served) -> psutil.Process:
    """Return the first one, or one that was started in its place."""
    children = psutil.Process(server.process.pid).children()
    (process,) = [child for child in children if is_fork_server(child)]
    return process


def is_fork_server(process: psutil.Process) -> bool:
    with suppress(psutil.Error):
        if process.status() != psutil.STATUS_ZOMBIE:
            return "forkserver" in " ".join(process.cmdline())
    return False


def test_jobs_are_forked_from_what_the_server_has_imported(launch: Callable[..., Served]) -> None:
    server = launch()
    parent = fork_server(server)
    run = server.moving(server.start(ENDLESS))
    (job,) = server.jobs()
    assert job.parent() == parent
    assert run["id"].startswith(job.name().removeprefix("training "))
    memory = job.memory_full_info()
    assert memory.uss < memory.rss / 2, "most of its memory is shared"
    assert job.open_files() == [], "not one of the server's, as its database"


def test_a_dead_fork_server_ends_its_jobs_and_is_replaced(launch: Callable[..., Served]) -> None:
    server = launch()
    run = server.start({**BODY, "steps": 200, "pace": 20, "evaluate_every": 0})
    server.moving(run)
    (job,) = server.jobs()
    fork_server(server).send_signal(signal.SIGKILL)
    ended = server.in_state(run, "failed")
    assert "its process ended" in ended["error"]
    assert ended["can_resume"]
    psutil.wait_procs([job], timeout=LONG_S)
    assert not job.is_running()

    assert server.tell(run, "resume").status_code == 202
    server.hurry(run["id"])
    again = server.in_state(run, "finished", "failed")
    assert again["state"] == "finished", again


def test_a_fork_server_that_dies_as_a_process_is_started_fails_no_run(
    launch: Callable[..., Served],
) -> None:
    server = launch()
    # The second one has to import everything first, so that it is killed meanwhile.
    for after_s in (0.0, 0.1):
        killed = fork_server(server)
        killed.suspend()
        run = server.start({**BODY, "steps": 20})
        time.sleep(after_s)
        killed.kill()
        assert server.in_state(run, "finished", "failed")["error"] is None


def test_a_fork_server_that_dies_before_a_run_does_anything_fails_no_run(
    launch: Callable[..., Served],
) -> None:
    server = launch()
    run = server.start({**SWEEP, "seeds": 2, "steps": 50_000}, "/experiments")
    while not (jobs := server.jobs()):
        time.sleep(0.01)
    # It is at its first trial, which is long, or before it.
    fork_server(server).kill()
    assert server.in_state(run, "finished", "failed")["error"] is None
    psutil.wait_procs(jobs, timeout=LONG_S)
    assert not any(job.is_running() for job in jobs), "not two at once"


def test_a_job_may_fork_processes_of_its_own(launch: Callable[..., Served]) -> None:
    server = launch()
    run = server.start(SWEEP, "/experiments")
    server.in_state(run, "running", "finished")
    assert server.in_state(run, "finished", "failed")["state"] == "finished"


def test_a_stopped_fork_server_keeps_no_run_waiting(launch: Callable[..., Served]) -> None:
    server = launch()
    server.moving(server.start(ENDLESS))
    fork_server(server).suspend()
    run = server.start({**BODY, "steps": 50})
    assert server.in_state(run, "finished", "failed")["state"] == "finished"


def test_a_stopped_fork_server_keeps_no_core_and_no_shutdown_waiting(
    launch: Callable[..., Served],
) -> None:
    """It reaps what it has forked, so that the end of a job is seen through it alone."""
    server = launch()
    cores = psutil.cpu_count() or 1
    body = {**BODY, "steps": 100, "pace": 20, "evaluate_every": 0}
    runs = [server.start(body) for _ in range(cores)]
    for run in runs:
        server.moving(run)
    fork_server(server).suspend()
    for run in runs:
        server.in_state(run, "finished")
    waited = server.start({**BODY, "steps": 50})
    assert server.in_state(waited, "finished", "failed")["state"] == "finished"
    server.moving(server.start(ENDLESS))
    fork_server(server).suspend()
    assert server.end() == 0
