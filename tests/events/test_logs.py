"""Log format: one line per record, with the id of its run; log records of state changes."""

import io
import json
import logging
from collections.abc import Iterator
from typing import Any

import pytest

from app.events import logs
from app.events.event_records import DeletedRun
from app.events.logs import LineFormatter
from app.events.run_metrics import RunMetrics
from tests.storage.stores import training


@pytest.fixture
def written() -> Iterator[io.StringIO]:
    root, stream = logging.getLogger(), io.StringIO()
    level, handlers = root.level, root.handlers[:]
    root.handlers.clear()
    logs.install("info", stream)
    yield stream
    root.handlers[:] = handlers
    root.setLevel(level)


def record(message: str, **more: Any) -> logging.LogRecord:
    return logging.makeLogRecord({"msg": message, "name": "app", "levelname": "INFO", **more})


def test_records_are_json_lines_on_a_stream(written: io.StringIO) -> None:
    logging.getLogger("app.x").info("two\n%s", "lines", extra={"run_id": "abc"})
    logging.getLogger("app.x").debug("nothing")
    try:
        1 / 0  # noqa: B018
    except ZeroDivisionError:
        logging.getLogger("app.y").exception("broken")
    first, second = map(json.loads, written.getvalue().splitlines())
    assert first.pop("time").endswith("+00:00")
    assert first == {
        "level": "info",
        "logger": "app.x",
        "message": "two\nlines",
        "run_id": "abc",
    }
    assert "ZeroDivisionError" in second["traceback"]


def test_terminal_format_is_key_value_with_escapes() -> None:
    line = LineFormatter(as_json=False).format(record('a "b"\x1b[2J\n', run_id="abc", n=3))
    assert line.endswith(r'level=info logger=app message="a \"b\"\u001b[2J\n" run_id=abc n=3')
    assert "\n" not in line


def test_run_id_is_taken_from_the_process_or_thread_name() -> None:
    formatter = LineFormatter(as_json=True)
    for names in ({"processName": "training abc"}, {"threadName": "race abc"}):
        assert json.loads(formatter.format(record("broken", **names)))["run_id"] == "abc"
    assert "run_id" not in json.loads(formatter.format(record("x", threadName="jobs")))


def test_steps_are_counted_and_state_changes_logged(written: io.StringIO) -> None:
    clock = [0.0]
    bus = RunMetrics(lambda: clock[0])

    def publish(state: str, done: int, error: str | None = None) -> None:
        run = training("abc", state=state, done=done, error=error)
        bus.publish_run(run)

    for state_and_done in (("queued", 0), ("running", 0), ("running", 30), ("running", 100)):
        publish(*state_and_done)
    assert (bus.steps, bus.steps_per_s) == (100, 10.0)
    clock[0] = 5.0
    publish("failed", 120, "It broke.")
    assert (bus.steps, bus.steps_per_s) == (120, 12.0)
    clock[0] = 12.0
    assert (bus.steps, bus.steps_per_s) == (120, 2.0)
    bus.publish("run-deleted", DeletedRun(id="abc"), "abc")
    logged = [json.loads(line) for line in written.getvalue().splitlines()]
    assert [entry["message"] for entry in logged] == [
        "training is queued",
        "training is running",
        "training is failed",
        "deleted",
    ]
    assert {entry["run_id"] for entry in logged} == {"abc"}
    assert (logged[2]["level"], logged[2]["error"]) == ("warning", "It broke.")
