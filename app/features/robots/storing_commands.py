"""Verbs of `hexapods robots` that change which robots are stored.

They go through the running server; without one, the command makes the changes itself.
"""

import argparse
import json
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import urlencode

from app.cli.server_client import call_server
from app.cli.stored_runs import add_data, open_for_reading, open_for_writing
from app.settings import Settings, read_settings
from hexapods.domain.errors import InvalidInput, UnknownName

if TYPE_CHECKING:
    from app.storage.database.store import RunStore
    from app.storage.stored_robot import StoredRobot

_MAX_BYTES = 64 << 20


def add_to(verbs: "argparse._SubParsersAction[Any]") -> None:
    """Add the verbs' parsers."""
    importing = verbs.add_parser(
        "import",
        help="store a robot from MJCF or URDF, alone or in a zip, or from a document that "
        "`hexapods robots export` wrote",
    )
    importing.add_argument(
        "file", metavar="FILE", help="MJCF, URDF, a zip, a document, or JSON with `robot`"
    )
    importing.add_argument("--name", help="its name (default: that of the file)")
    hiding = verbs.add_parser("hide", help="leave a stored robot out where robots are chosen")
    hiding.add_argument("--undo", action="store_true", help="offer it again")
    renaming = verbs.add_parser("rename", help="give a stored robot another name")
    renaming.add_argument("--name", required=True, help="its new name")
    deleting = verbs.add_parser("delete", help="delete a stored robot that no run uses")
    for verb, run in (
        (importing, _import),
        (hiding, _hide),
        (renaming, _rename),
        (deleting, _delete),
    ):
        verb.set_defaults(run=run)
        add_data(verb)
        verb.add_argument("--json", action="store_true", help="print JSON")
    for verb in (hiding, renaming, deleting):
        verb.add_argument("robot", metavar="NAME", help="name or id of a stored robot")


def _import(options: argparse.Namespace) -> int:
    settings, path = read_settings(data=options.data), Path(options.file)
    try:
        with path.open("rb") as file:
            data = file.read(_MAX_BYTES + 1)
    except OSError as error:
        raise InvalidInput(f"cannot read {path}: {error.strerror}") from error
    name = options.name or path.stem

    def store_it(store: "RunStore") -> "StoredRobot":
        # Imported here, as it loads the jobs.
        from app.features.robots.robot_import import import_robot  # noqa: PLC0415

        return import_robot(store, data, name, path.name)[0]

    query = urlencode({"name": name, "file": path.name})
    told = _changed(settings, store_it, ("POST", f"api/v1/robots?{query}", data))
    lines = [f"{path} is robot {told['name']} ({told['id']}) here."]
    lines += [f"Guessed: {one}" for one in told["guesses"]]
    lines += [f"Repaired: {one}" for one in told["repairs"]]
    return _print(options, told, "\n".join(lines))


def _hide(options: argparse.Namespace) -> int:
    told = _change(options, hidden=not options.undo)
    how = "is offered again" if options.undo else "is hidden"
    return _print(options, told, f"{told['name']} {how}.")


def _rename(options: argparse.Namespace) -> int:
    told = _change(options, name=options.name)
    return _print(options, told, f"It is {told['name']} now.")


def _change(options: argparse.Namespace, **changes: Any) -> dict[str, Any]:
    settings = read_settings(data=options.data)
    robot_id = find_stored(settings, options.robot).id
    request = ("PATCH", f"api/v1/robots/{robot_id}", json.dumps(changes).encode())
    told: dict[str, Any] = _changed(
        settings, lambda store: store.robots.change(robot_id, **changes), request
    )
    return told


def _delete(options: argparse.Namespace) -> int:
    settings = read_settings(data=options.data)
    found = find_stored(settings, options.robot)

    def delete(store: "RunStore") -> None:
        # Imported here, as they load all features.
        from app.active_features import keep_named_robots  # noqa: PLC0415
        from app.installed_features import load  # noqa: PLC0415

        keep_named_robots(load(settings.without), store)
        store.robots.delete(found.id)

    _changed(settings, delete, ("DELETE", f"api/v1/robots/{found.id}", None))
    return _print(options, {"deleted": found.id}, f"Deleted robot {found.name} ({found.id}).")


def find_stored(settings: Settings, text: str) -> "StoredRobot":
    """Return the stored robot of a name or an id.

    Raises:
        UnknownName: if there is none.
    """
    with open_for_reading(settings) as store:
        found = store.robots.find(text)
        names = [one.name for one in store.robots.stored(hidden=True)]
    if found is None:
        raise UnknownName("stored robot", text, names or ["none yet; `hexapods robots import`"])
    return found


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


def _print(options: argparse.Namespace, told: Any, sentence: str) -> int:
    print(json.dumps(told) if options.json else sentence)
    return 0
