"""Reads a robot's file in a child process with limits, since its parsers are not to be trusted.

The child has a share of processor time and of memory, writes no file, works in an empty folder that
has no name any more, so that nothing is left of it even after SIGKILL, and is killed with its group
when its time is over. Its answer comes as JSON, and is validated here.
"""

import json
import logging
import math
import os
import signal
import sys
import tempfile
import threading
import time
import warnings
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import psutil

from hexapods.domain.errors import DamagedFile, HexapodError, InvalidInput
from hexapods.domain.records import from_json, to_json
from hexapods.domain.text import message, visible
from hexapods.imports.choices import AS_FOUND, Choices, check_choices
from hexapods.imports.documents.upload import MAX_UPLOAD_BYTES
from hexapods.imports.imported import ImportedRobot, RobotReading
from hexapods.processes import Child, SetUp

_MAX_ANSWER_BYTES = 16 << 20
_MAX_ERROR = 1000
_START_S = 60.0
"""Time in which the child imports what it needs, where it is no fork of a process that has."""
_CHECK_EVERY_S = 0.05
_MOST_OF_TIME = 0.9
"""Of the processor's time, after which a file takes too long, and not the machine."""
_OPEN_FILES = 64
_READY = b"ready"
_TURNS = threading.BoundedSemaphore(2)
"""Held while a file is read; others wait, since each may take much memory."""
_logger = logging.getLogger(__name__)


class NotRead(HexapodError):
    """No process could read the file: none could be started, or it got hardly any time.

    The file itself may be valid.
    """


@dataclass(frozen=True)
class ReadingLimits:
    """Limits of the resources for reading a file.

    Attributes:
        seconds: of the processor.
        clock_seconds: on the clock, of which a busy machine gives a process only a part.
        memory_bytes: beyond what the interpreter has with its modules.
    """

    seconds: float = 5.0
    clock_seconds: float = 30.0
    memory_bytes: int = 512 << 20


LIMITS = ReadingLimits()


def read_robot_file(
    data: bytes,
    file_name: str | None = None,
    choices: Choices = AS_FOUND,
    limits: ReadingLimits = LIMITS,
) -> ImportedRobot:
    """Read a robot from an MJCF, URDF or xacro file, alone or in a zip with meshes.

    Args:
        data: the file.
        file_name: its name, for messages and as the robot's name if the file gives none.
        choices: what a person decided; all else is found out.
        limits: what it may take.

    Raises:
        InvalidInput: one sentence: what is wrong with the file or a choice, and what is valid.
        NotRead: if no process can be started.
    """
    return inspect_robot_file(data, file_name, choices, limits).valid_robot()


def inspect_robot_file(
    data: bytes,
    file_name: str | None = None,
    choices: Choices = AS_FOUND,
    limits: ReadingLimits = LIMITS,
) -> RobotReading:
    """Read a file for a person to look at: what is no robot yet is drawn, too.

    Arguments as those of `read_robot_file`.

    Raises:
        InvalidInput: if the file cannot even be drawn: what is wrong with it, and what is valid.
        NotRead: if no process can be started.
    """
    check_choices(choices)
    if len(data) > MAX_UPLOAD_BYTES:
        raise DamagedFile(
            f"the file has {len(data):,} bytes; a robot has at most {MAX_UPLOAD_BYTES:,}"
        )
    with _TURNS:
        answer = _ask(
            {
                "file_name": visible(file_name or "robot.xml")[-200:],
                "choices": to_json(choices),
                "seconds": limits.seconds,
                "memory_bytes": limits.memory_bytes,
            },
            data,
            limits,
        )
    return _reading(answer)


def _ask(head: dict[str, Any], data: bytes, limits: ReadingLimits) -> bytes:
    """Return the answer of a child that reads the file.

    Raises:
        DamagedFile: if it took too long or too much, or ended without an answer.
        NotRead: if it ended before it was given the file.
    """
    try:
        temporary = {"TMPDIR": tempfile.gettempdir()}
        child = Child(_answer_once, SetUp(name="robot import", niceness=5, environment=temporary))
        child.start()
    except OSError as error:
        raise _not_read(str(error)) from error
    try:
        _wait_until_ready(child)
        with suppress(OSError):  # it has ended, which is seen next
            child.pipe.send_bytes(json.dumps(head).encode())
            child.pipe.send_bytes(data)
        _wait(child, limits)
        return child.pipe.recv_bytes(_MAX_ANSWER_BYTES)
    except (EOFError, OSError):
        child.kill()
        raise DamagedFile(_why_it_ended(child.end(), limits)) from None
    finally:
        child.kill()
        child.end()
        child.pipe.close()


def _wait_until_ready(child: Child) -> None:
    """Wait until the child has imported what it needs, and has a folder.

    Raises:
        NotRead: if it does not in `_START_S`, or ends.
    """
    if not child.wait(_START_S):
        raise _not_read(f"it has not begun after {_START_S:g} s")
    try:
        said = child.pipe.recv_bytes(_MAX_ERROR)
    except (EOFError, OSError):
        raise _not_read("it ended as it began") from None
    if said != _READY:
        raise _not_read(said.decode())


def _not_read(reason: str) -> NotRead:
    return NotRead(f"the process that reads robots' files cannot be started ({reason}); try again")


def _wait(child: Child, limits: ReadingLimits) -> None:
    """Wait until the child has sent something.

    Raises:
        DamagedFile: if it does not in this time, or takes too much memory.
        NotRead: if the machine gave it hardly any of its time.
        EOFError: if it has ended.
    """
    deadline_s = time.monotonic() + limits.clock_seconds
    at_start, began_s = child.memory_bytes(), child.processor_s()
    while not child.wait(_CHECK_EVERY_S):
        used_s = child.processor_s() - began_s
        # The child's own limits are finer, but Windows has none.
        if used_s > _whole(limits.seconds):
            raise DamagedFile(_too_long(limits.seconds))
        if time.monotonic() > deadline_s:
            if used_s < _MOST_OF_TIME * limits.seconds:
                raise NotRead(
                    f"the machine is busy: within {limits.clock_seconds:g} s it spent only "
                    f"{used_s:.1f} s on reading the file; try again"
                )
            raise DamagedFile(_too_long(limits.clock_seconds))
        if child.memory_bytes() - at_start > limits.memory_bytes:
            raise DamagedFile(_too_much_memory(limits.memory_bytes))
    if not child.pipe.poll():
        raise EOFError


def _why_it_ended(code: int | None, limits: ReadingLimits) -> str:
    if sys.platform != "win32" and code in (-signal.SIGXCPU, -signal.SIGKILL):
        return _too_long(limits.seconds)
    return (
        "MuJoCo breaks down on the file: something in it, most likely a mesh, is not as its "
        "format says"
    )


def _too_long(seconds: float) -> str:
    return f"reading it takes longer than {seconds:g} s: simplify it, above all its meshes"


def _too_much_memory(most_bytes: int) -> str:
    return f"reading it takes more than {most_bytes >> 20} MB: simplify it, above all its meshes"


def _reading(answer: bytes) -> RobotReading:
    """Validate the answer of a child."""
    try:
        answer_document = json.loads(answer)
        error = answer_document.get("error")
        if error is None:
            return from_json(RobotReading, answer_document["reading"])
        kind = DamagedFile if answer_document.get("is_damaged") else InvalidInput
    except (ValueError, KeyError, AttributeError, TypeError) as problem:
        _logger.warning("the process that reads robots gave no valid answer: %s", problem)
        raise DamagedFile(f"the file makes no valid robot: {_cut(str(problem))}") from problem
    raise kind(_cut(str(error)))


def _cut(text: str) -> str:
    line = " ".join(visible(message(text), "\n").split())
    return line if len(line) <= _MAX_ERROR else f"{line[: _MAX_ERROR - 1]}…"


def _answer_once(pipe: Connection) -> None:
    """Read one file and send the answer: the function that the child process runs."""
    # Here, so that the parent imports no parser of foreign files.
    from hexapods.imports.compiling import silence_mujoco  # noqa: PLC0415
    from hexapods.imports.reading import read_in_this_process  # noqa: PLC0415

    silence_mujoco()
    warnings.simplefilter("ignore")  # of NumPy and MuJoCo, on files that are refused or mended
    try:
        _enter_empty_folder()
    except OSError as error:
        pipe.send_bytes(str(error).encode()[:_MAX_ERROR])
        return
    pipe.send_bytes(_READY)
    head = json.loads(pipe.recv_bytes())
    _limit(head)
    try:
        data = pipe.recv_bytes()
        choices = from_json(Choices, head["choices"])

        def read() -> dict[str, Any]:
            return {"reading": to_json(read_in_this_process(data, head["file_name"], choices))}

        answer = json.dumps(_reading_or_error(read, head["memory_bytes"])).encode()
    except MemoryError:
        answer = json.dumps({"error": _too_much_memory(head["memory_bytes"])}).encode()
    pipe.send_bytes(answer)


def _reading_or_error(read: Callable[[], dict[str, Any]], memory_bytes: int) -> dict[str, Any]:
    """Return the robot that was read, or the error as a sentence, in plain types."""
    try:
        return read()
    except DamagedFile as error:
        return {"error": str(error), "is_damaged": True}
    except HexapodError as error:
        return {"error": str(error)}
    except MemoryError:
        return {"error": _too_much_memory(memory_bytes), "is_damaged": True}
    except RecursionError:
        return {"error": "it is nested too deeply", "is_damaged": True}
    except Exception as error:  # of a file that nobody thought of; the limits hold all the same
        return {
            "error": f"the file cannot be understood ({type(error).__name__}: {error})",
            "is_damaged": True,
        }


def _enter_empty_folder() -> None:
    """Clear the environment variables, and change to an empty folder that is already deleted.

    No file can be made in it. On Windows, where it could not be deleted, it is the folder of
    temporary files.

    Raises:
        OSError: if it cannot be made.
    """
    folder = tempfile.gettempdir()
    if sys.platform == "win32":
        os.chdir(folder)
    else:
        folder = tempfile.mkdtemp(prefix="robot-import-")
        try:
            os.chdir(folder)
        finally:
            Path(folder).rmdir()
    os.environ.clear()
    os.environ["TMPDIR"] = tempfile.tempdir = folder


def _limit(head: dict[str, Any]) -> None:
    """Limit the resources of this process."""
    if sys.platform == "win32":
        return
    import resource  # noqa: PLC0415 - not on Windows

    is_linux = sys.platform == "linux"
    for kind, most in (
        # Where it is no fork, it has spent a second on its imports.
        (resource.RLIMIT_CPU, _whole(time.process_time() + head["seconds"])),
        (resource.RLIMIT_FSIZE, 0),
        (resource.RLIMIT_CORE, 0),
        (resource.RLIMIT_NOFILE, _OPEN_FILES),
        *([(resource.RLIMIT_AS, _address_space() + head["memory_bytes"])] if is_linux else []),
    ):
        hard = resource.getrlimit(kind)[1]
        least = most if hard == resource.RLIM_INFINITY else min(most, hard)
        resource.setrlimit(kind, (least, least))


def _whole(seconds: float) -> int:
    """Return the next whole number of seconds, in which systems count a limit."""
    return math.ceil(seconds)


def _address_space() -> int:
    """Return the size of this process's address space [bytes]."""
    return int(psutil.Process().memory_info().vms)
