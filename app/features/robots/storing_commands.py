"""Verbs of `hexapods robots` that change which robots are stored.

They go through the running server; without one, the command makes the changes itself.
"""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any
from urllib.parse import urlencode

from cyclopts import Parameter

from app.cli.options import AsJson, Data
from app.cli.server_client import call_server
from app.cli.stored_runs import open_for_reading, open_for_writing
from app.settings import Settings, read_settings
from hexapods.domain.errors import UnknownName
from hexapods.imports.folder import read_robot_path

if TYPE_CHECKING:
    from app.storage.database.store import RunStore
    from app.storage.stored_robot import StoredRobot

Name = Annotated[str, Parameter(name="NAME", help="name or id of a stored robot")]


def import_robot(
    file: Annotated[str, Parameter(name="FILE")],
    /,
    *,
    name: str | None = None,
    data: Data = None,
    as_json: AsJson = False,
) -> int:
    """Store a robot from MJCF or URDF, alone or in a folder or zip, or from a document.

    `hexapods robots export` writes documents.

    Args:
        file: MJCF, URDF, a folder or zip with one, a document, or JSON with `robot`
        name: its name (default: that of the file)

    Raises:
        HexapodError: if it cannot be read or stored.
    """
    settings, path = read_settings(data=data), Path(file)
    content, file_name = read_robot_path(path)
    name = name or _name(path)

    def store_it(store: "RunStore") -> "StoredRobot":
        # Imported here, as it loads the jobs.
        from app.features.robots import robot_import  # noqa: PLC0415

        return robot_import.import_robot(store, content, name, file_name)[0]

    query = urlencode({"name": name, "file": file_name})
    view = _changed(settings, store_it, ("POST", f"api/v1/robots?{query}", content))
    lines = [f"{path} is robot {view['name']} ({view['id']}) here."]
    lines += [f"Guessed: {guess}" for guess in view["guesses"]]
    lines += [f"Repaired: {repair}" for repair in view["repairs"]]
    return _print(view, "\n".join(lines), as_json)


def _name(path: Path) -> str | None:
    """Return the name of a file or folder for its robot; of a person's home folder none."""
    path = path.resolve()
    if path == Path.home():
        return None
    return path.name if path.is_dir() else path.stem


def hide_robot(
    robot: Name,
    /,
    *,
    undo: bool = False,
    data: Data = None,
    as_json: AsJson = False,
) -> int:
    """Leave a stored robot out where robots are chosen.

    Args:
        undo: offer it again

    Raises:
        HexapodError: if there is none of this name, or it cannot be changed.
    """
    view = _change(robot, data, hidden=not undo)
    state = "is offered again" if undo else "is hidden"
    return _print(view, f"{view['name']} {state}.", as_json)


def rename_robot(
    robot: Name,
    /,
    *,
    name: str,
    data: Data = None,
    as_json: AsJson = False,
) -> int:
    """Give a stored robot another name.

    Args:
        name: its new name

    Raises:
        HexapodError: if there is none of this name, or it cannot be changed.
    """
    view = _change(robot, data, name=name)
    return _print(view, f"It is {view['name']} now.", as_json)


def _change(robot: str, data: str | None, **changes: Any) -> dict[str, Any]:
    settings = read_settings(data=data)
    robot_id = find_stored(settings, robot).id
    request = ("PATCH", f"api/v1/robots/{robot_id}", json.dumps(changes).encode())
    view: dict[str, Any] = _changed(
        settings, lambda store: store.robots.change(robot_id, **changes), request
    )
    return view


def delete_robot(robot: Name, /, *, data: Data = None, as_json: AsJson = False) -> int:
    """Delete a stored robot that no run uses.

    Raises:
        HexapodError: if there is none of this name, or it cannot be deleted.
    """
    settings = read_settings(data=data)
    stored = find_stored(settings, robot)

    def delete(store: "RunStore") -> None:
        # Imported here, as they load all features.
        from app.active_features import keep_named_robots  # noqa: PLC0415
        from app.installed_features import load  # noqa: PLC0415

        keep_named_robots(load(settings.without), store)
        store.robots.delete(stored.id)

    _changed(settings, delete, ("DELETE", f"api/v1/robots/{stored.id}", None))
    return _print({"deleted": stored.id}, f"Deleted robot {stored.name} ({stored.id}).", as_json)


VERBS: Mapping[str, Callable[..., int]] = {
    "import": import_robot,
    "hide": hide_robot,
    "rename": rename_robot,
    "delete": delete_robot,
}


def find_stored(settings: Settings, text: str) -> "StoredRobot":
    """Return the stored robot of a name or an id.

    Raises:
        UnknownName: if there is none.
    """
    with open_for_reading(settings) as store:
        robot = store.robots.find(text)
        names = [stored.name for stored in store.robots.stored(hidden=True)]
    if robot is None:
        raise UnknownName("stored robot", text, names or ["none yet; `hexapods robots import`"])
    return robot


def _changed(
    settings: Settings,
    work: Callable[["RunStore"], "StoredRobot | None"],
    request: tuple[str, str, bytes | None],
) -> Any:
    """Make a change, by the running server if there is one; return the robot as in its answers."""
    from app.storage.server_lock import FolderInUse  # noqa: PLC0415
    from hexapods.domain.records import to_json  # noqa: PLC0415

    try:
        with open_for_writing(settings) as store:
            changed = work(store)
            return None if changed is None else to_json(changed)
    except FolderInUse:
        return call_server(settings, *request, media_type="application/json")


def _print(view: Any, sentence: str, as_json: bool) -> int:
    print(json.dumps(view) if as_json else sentence)
    return 0
