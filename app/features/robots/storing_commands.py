"""Verbs of `hexapods robots` that change which robots are stored.

They go through the running server; without one, the command makes the changes itself.
"""

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any
from urllib.parse import urlencode

from cyclopts import Parameter, Token

from app.cli.files import check_writable, write_whole
from app.cli.options import AsJson, Data
from app.cli.server_client import call_server
from app.cli.stored_runs import open_for_reading, open_for_writing
from app.features.robots.readings import KeptFile, is_model_file
from app.settings import Settings, read_settings
from hexapods.domain.errors import HexapodError, InvalidInput, UnknownName
from hexapods.domain.gait import resolve
from hexapods.domain.records import from_json, to_json
from hexapods.extras import needs
from hexapods.imports.child import inspect_robot_file
from hexapods.imports.choices import AS_FOUND, Choices
from hexapods.imports.documents.folder import read_robot_path
from hexapods.imports.imported import ImportedRobot, RobotReading
from hexapods.imports.notes import Note, listed, quoted

if TYPE_CHECKING:
    from app.storage.database.store import RunStore
    from app.storage.stored_robot import StoredRobot


def _choices(_: Any, tokens: Sequence[Token]) -> Choices:
    """Read choices as JSON; a ValueError says what is wrong with them."""
    try:
        return from_json(Choices, json.loads(tokens[0].value))
    except json.JSONDecodeError as error:
        raise ValueError(f"must be a JSON object of choices: {error}") from error


Name = Annotated[str, Parameter(name="NAME", help="name or id of a stored robot")]


def import_robot(
    file: Annotated[str, Parameter(name="FILE")],
    /,
    *,
    name: str | None = None,
    choices: Annotated[
        Choices | None, Parameter(metavar="JSON", converter=_choices, accepts_keys=False)
    ] = None,
    picture: Annotated[str | None, Parameter(metavar="FILE.png")] = None,
    data: Data = None,
    as_json: AsJson = False,
) -> int:
    """Store a robot from MJCF, URDF or xacro, alone or in a folder or zip, or from a document.

    `hexapods robots export` writes documents.

    Args:
        file: MJCF, URDF, xacro, a folder or zip with one, a document, or JSON with `robot`
        name: its name (default: that of the file)
        choices: what to take instead of what is guessed: '{"forward": "y", "scale": 0.1}'
        picture: file for a picture of what was read, also of a robot that is refused

    Raises:
        HexapodError: if it cannot be read or stored.
    """
    settings, path = read_settings(data=data), Path(file)
    content, file_name = read_robot_path(path)
    name = name or _name(settings, path)
    if not is_model_file(content):
        if choices is not None or picture is not None:
            raise InvalidInput("--choices and --picture are for MJCF, URDF, and zips with them")
        return _import_document(settings, path, content, name, file_name, as_json=as_json)
    chosen = choices or AS_FOUND
    reading = inspect_robot_file(content, file_name, chosen)
    if picture is not None:
        _draw(reading, picture)
    if reading.robot is None:
        notes = _sentences(reading.notes)
        feet = listed(foot.name for foot in reading.sketch.feet)
        hint = f"\nWhat could be feet: {feet}" if feet else ""
        raise InvalidInput("\n".join([f"{reading.problem}{hint}", *notes]))
    view = _store(settings, reading.robot, KeptFile(file_name, content), name, chosen)
    lines = [f"{path} is robot {view['name']} ({view['id']}) here."]
    lines += _description(reading.robot)
    return _print(view, "\n".join(lines + _sentences(reading.notes)), as_json)


def _import_document(
    settings: Settings,
    path: Path,
    content: bytes,
    name: str | None,
    file_name: str,
    *,
    as_json: bool,
) -> int:
    def store_it(store: "RunStore") -> "StoredRobot":
        # Imported here, as it loads the jobs.
        from app.features.robots import robot_import  # noqa: PLC0415

        return robot_import.import_robot(store, content, name, file_name)[0]

    query = urlencode({"name": name, "file": file_name})
    view = _changed(settings, store_it, ("POST", f"api/v1/robots?{query}", content))
    return _print(view, f"{path} is robot {view['name']} ({view['id']}) here.", as_json)


def _store(
    settings: Settings, robot: ImportedRobot, kept: KeptFile, name: str | None, choices: Choices
) -> Any:
    """Store a robot that was read; with a server, that reads the file again itself."""
    from app.storage.server_lock import FolderInUse  # noqa: PLC0415

    try:
        with open_for_writing(settings) as store:
            from app.features.robots import robot_import  # noqa: PLC0415 - loads the jobs

            return to_json(robot_import.import_reading(store, robot, kept, name, choices)[0])
    except FolderInUse:
        path = f"api/v1/robots/readings?{urlencode({'file': kept.name})}"
        reading = call_server(settings, "POST", path, kept.data)
        body = {"reading": reading["id"], "choices": to_json(choices), "name": name}
        return call_server(settings, "POST", "api/v1/robots", body)


def _draw(reading: RobotReading, file: str) -> None:
    """Write a picture of what was read.

    Raises:
        MissingExtra: if a package, or OpenGL, is missing that draws it.
        InvalidInput: if the file cannot be written, or is no .png.
    """
    if Path(file).suffix.lower() != ".png":
        raise InvalidInput(f"the name of the picture must end with .png: {file}")
    check_writable(file)
    with needs("video", "a picture"):
        from hexapods.exports.sketch_picture import sketch_png  # noqa: PLC0415 - loads OpenGL
    groups: Sequence[Sequence[int]] = ()
    if (imported := reading.robot) is not None:
        azimuths_deg = imported.robot(imported.name).azimuths_deg
        groups = resolve(imported.gait, azimuths_deg).groups
    write_whole(file, sketch_png(reading.sketch, groups))


def _description(robot: ImportedRobot) -> list[str]:
    legs = "; ".join(
        f"{number} {', '.join(map(quoted, leg.joints))} to {quoted(leg.foot)}"
        for number, leg in enumerate(robot.legs, start=1)
    )
    return [
        f"It has {len(robot.legs)} legs and {robot.mass_kg:.3g} kg; its torso stands "
        f"{1000 * robot.body_height_m:.0f} mm above its feet.",
        f"Legs, anticlockwise from the front right one: {legs}.",
    ]


def _sentences(notes: Iterable[Note]) -> list[str]:
    """Return notes as lines, guesses first, each with the choices that it offers."""
    kinds = {"guess": "Guessed", "repair": "Repaired"}
    ordered = sorted(notes, key=lambda note: note.kind == "repair")
    return [f"{kinds[note.kind]}: {note.text}{_offer(note)}" for note in ordered]


def _offer(note: Note) -> str:
    if note.offer is None:
        return ""
    choices = {key: value for key, value in to_json(note.offer).items() if value is not None}
    return f" (else: --choices '{json.dumps(choices)}')"


def _name(settings: Settings, path: Path) -> str | None:
    """Return the name of a file or folder for its robot, made distinct; None of a home folder."""
    from app.storage.stored_robot import distinct_name  # noqa: PLC0415

    path = path.resolve()
    if path == Path.home():
        return None
    taken: list[str] = []
    with suppress(HexapodError), open_for_reading(settings) as store:  # there may be no store yet
        taken = [stored.name for stored in store.robots.stored(hidden=True)]
    return distinct_name(path.name if path.is_dir() else path.stem, taken)


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

    try:
        with open_for_writing(settings) as store:
            changed = work(store)
            return None if changed is None else to_json(changed)
    except FolderInUse:
        return call_server(settings, *request, media_type="application/json")


def _print(view: Any, sentence: str, as_json: bool) -> int:
    print(json.dumps(view) if as_json else sentence)
    return 0
