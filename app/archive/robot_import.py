"""Import of a robot: a body, the document of a robot, or, by and by, a robot's file."""

import json
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

from app.storage.database.store import RunStore
from app.storage.stored_robot import StoredRobot, distinct_name
from hexapods.domain import robot_documents
from hexapods.domain.creatures import own_gait
from hexapods.domain.errors import DamagedFile, InvalidInput
from hexapods.domain.gait import GaitSpec, gait_spec, read_gait, resolve
from hexapods.domain.robot import Robot, document_of, parse_document, robot
from hexapods.domain.support import STANDS_M, Support
from hexapods.domain.text import check_name
from hexapods.runs.config import WalkingProblem
from hexapods.runs.preview import preview

MEMBERS = ("robot", "gait", "name")
"""Of the JSON by which a body is stored."""
_UNNAMED = "Robot"
_NAMED = ("tripod", "tetrapod", "trot")
"""Gaits that are tried for a robot of which none is known, with their few groups."""
_FALLBACK = "one-by-one"


def import_robot(store: RunStore, data: bytes, name: str | None = None) -> tuple[StoredRobot, bool]:
    """Store a robot, unless it is stored already.

    Args:
        store: receives it.
        data: `{"robot": …, "gait": …, "name": …}`, of which gait and name may be missing, or the
            document of a robot.
        name: its name; by default what the data say, or `Robot`, made distinct.

    Returns:
        the robot as stored, and whether it is new.

    Raises:
        InvalidInput: if it is no robot, or one that cannot stand or reach its feet's homes.
        DamagedFile: if its document was changed.
        Conflict: if another robot has its name.
        StorageFull: if there are too many, or too little disk space.
    """
    content = _json(data)
    if "format" in content:
        made, document = parse_document(data), data
        content = {}
    else:
        made = robot(_member(content, "robot"))
        document = document_of(made)
        parse_document(document)  # which refuses numbers out of their limits
    given_gait = content.get("gait")
    gait = suiting_gait(made) if given_gait is None else read_gait(given_gait)
    check_stands(made, gait)
    given = name if name is not None else content.get("name")
    about = StoredRobot(
        id=robot_documents.id_of(document),
        name=_named(store, given),
        gait=gait,
    )
    return store.robots.add(document, about)


def suiting_gait(made: Robot) -> str | GaitSpec:
    """Return its preset's gait, a named one with which it stands, or the fewest groups that do."""
    if (own := own_gait(made)) != _FALLBACK:
        return own
    for name in _NAMED:
        with suppress(InvalidInput):  # it does not divide these legs
            gait = resolve(name, made.azimuths_deg)
            if Support(made, gait).least_margin_m(gait.groups) >= STANDS_M:
                return name
    spec = gait_spec(_FALLBACK)
    groups = Support(made, resolve(spec, made.azimuths_deg)).steadiest_groups()
    return GaitSpec(spec.right_leg, spec.left_leg, groups=groups)


def check_stands(made: Robot, gait: str | GaitSpec) -> None:
    """Check that a robot stands, and that its legs reach some foot grid.

    Raises:
        InvalidInput: if they do not, naming a leg, or the gait does not divide its legs.
    """
    known = preview(WalkingProblem(gait=gait, robot=made))
    if known.largest_side_m is None:
        raise InvalidInput(f"it cannot walk on any foot grid: {known.out_of_reach}")
    if not known.stands:
        raise InvalidInput(
            "it does not stand even on all of its feet, since its centre of mass is not above "
            "them; move a leg's foot"
        )


def _named(store: RunStore, given: Any) -> str:
    if given is None:
        return distinct_name(_UNNAMED, [one.name for one in store.robots.stored(hidden=True)])
    if not isinstance(given, str) or not (name := check_name(given)):
        raise InvalidInput("a robot has a name with a visible character")
    return name


def _json(data: bytes) -> dict[str, Any]:
    told = (
        'send {"robot": …}, with a robot as in any request, or the document of a robot as '
        "`GET /robots/{id}/file` and `hexapods robots export` give it"
    )
    if len(data) > robot_documents.MAX_BYTES:
        raise InvalidInput(f"a robot has at most {robot_documents.MAX_BYTES:,} bytes; {told}")
    try:
        content = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise InvalidInput(f"it is no JSON: {told}") from error
    if not isinstance(content, Mapping):
        raise InvalidInput(f"it is no JSON object: {told}")
    unknown = [one for one in content if one not in MEMBERS]
    if "format" not in content and unknown:
        raise InvalidInput(f"unknown member {unknown[0][:100]!r}: {told}")
    return dict(content)


def _member(content: Mapping[str, Any], name: str) -> Any:
    if name not in content:
        raise DamagedFile(f"it has no {name}")
    return content[name]
