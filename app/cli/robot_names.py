"""Stored robots where a command takes a robot: found by name or id in the data folder."""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from app.cli.stored_runs import open_for_reading
from app.settings import ROBOTS_FOLDER, read_settings
from hexapods.domain.errors import HexapodError, InvalidInput, UnknownName
from hexapods.domain.robot import PRESETS, Robot
from hexapods.domain.robot_library import LIBRARY

_data: ContextVar[str | None] = ContextVar("data", default=None)
"""The data folder that an option of the command says."""


@contextmanager
def stored_robots_known(data: str | None) -> Iterator[None]:
    """Find stored robots by their ids in the data folder, as long as the context lasts.

    Args:
        data: the data folder, if an option says it.
    """
    try:
        folder = read_settings(data=data).data / ROBOTS_FOLDER
    except InvalidInput:  # a command that needs the settings says what is wrong with them
        yield
        return
    LIBRARY.add_folder(folder)
    reset = _data.set(data)
    try:
        yield
    finally:
        _data.reset(reset)
        LIBRARY.remove_folder(folder)


def stored_robot(text: str) -> Robot:
    """Return the stored robot of a name or an id.

    Raises:
        UnknownName: if there is none; it names all robots.
    """
    try:
        with open_for_reading(read_settings(data=_data.get())) as store:
            stored = store.robots.find(text)
            names = [robot.name for robot in store.robots.stored()]
    except HexapodError as error:
        unknown = UnknownName("robot", text, PRESETS)
        raise InvalidInput(f"{unknown}. Stored robots cannot be read: {error}") from error
    if stored is None:
        raise UnknownName("robot", text, [*PRESETS, *names])
    LIBRARY.describe(stored.id, stored.about)
    return stored.robot
