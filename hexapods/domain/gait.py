"""Gaits in the paper's sense: the robot's forward direction, and the groups of its legs.

Elsewhere in the field a gait is a pattern of footfalls over time. Here (paper §4, Figure 2) it is
an orientation of the robot and a symmetry that pairs its legs; the pattern over time is learned.
Here the legs are divided into groups of any size, of which a step moves one: the paper's pairs are
groups of two. The feet of a group go to the same cell, mirrored on the left of the body.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from operator import index
from typing import Annotated, Any, Literal, get_args

from hexapods.domain.body import MAX_LEGS
from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.records import JsonForm, Schema
from hexapods.domain.short_repr import short_repr
from hexapods.domain.types import FloatArray

Symmetry = Literal["origin", "vertical"]
Grouping = Literal["tripod", "tetrapod", "trot", "pace", "bound", "one-by-one"]
"""A rule that divides the legs of a robot into groups; see `_groups_by`."""
Pair = tuple[int, int]
"""(leader, partner), legs counted from 1: the leader goes to (x, y), its partner to (−x, y)."""
Group = tuple[int, ...]
"""Legs that move together, counted from 1."""

_SAME_DIRECTION_DEG = 1e-6
_PAIRS, _GROUPS = "[[1, 4], [2, 5], [3, 6]]", "[[1, 3, 5], [2, 4, 6]]"
"""Examples, for error messages."""


@dataclass(frozen=True)
class GaitSpec:
    """Specification of a gait, independent of a robot; `resolve` applies it to one.

    Attributes:
        right_leg, left_leg: forward is the bisector of the anticlockwise arc from the right to
            the left leg; legs count from 1, anticlockwise seen from above.
        symmetry: how legs are paired by their azimuths: `origin` pairs opposite legs, `vertical`
            mirror images about the forward axis. Either this or `pairs` or `groups` is given.
        pairs: the explicit pairs.
        groups: explicit groups of any size, or the name of a rule that makes them. Their feet are
            mirrored by the side of the body on which they stand.

    Raises:
        InvalidInput: unless one of symmetry, pairs and groups is given, or if a leg is no number.
        UnknownName: if the symmetry or the rule is unknown.
    """

    __repr__ = short_repr

    right_leg: int
    left_leg: int
    symmetry: Symmetry | None = None
    pairs: tuple[Pair, ...] | None = None
    groups: tuple[Group, ...] | Grouping | None = None

    def __post_init__(self) -> None:
        options = self.symmetry, self.pairs, self.groups
        if sum(option is not None for option in options) != 1:
            raise InvalidInput(
                "a gait needs one of symmetry (origin or vertical), pairs, and groups of legs"
            )
        if self.symmetry is not None and self.symmetry not in get_args(Symmetry):
            raise UnknownName("symmetry", self.symmetry, get_args(Symmetry))
        for name in ("right_leg", "left_leg"):
            object.__setattr__(self, name, _leg_number(name, getattr(self, name)))
        if self.pairs is not None:
            object.__setattr__(self, "pairs", _pairs_of_legs(self.pairs))
        if isinstance(self.groups, str):
            if self.groups not in get_args(Grouping):
                raise UnknownName("grouping", self.groups, get_args(Grouping))
        elif self.groups is not None:
            object.__setattr__(self, "groups", _groups_of_legs(self.groups))


def _leg_number(name: str, leg: object) -> int:
    """Return a leg's number, of NumPy too, as an `int`.

    Raises:
        InvalidInput: if it is not a whole number.
    """
    try:
        if not isinstance(leg, bool):
            return index(leg)  # type: ignore[arg-type]  # its TypeError is handled below
    except TypeError:
        pass
    raise InvalidInput(f"{name} must be the number of a leg, a whole number from 1, not {leg!r}")


def _pairs_of_legs(pairs: object) -> tuple[Pair, ...]:
    try:
        read = [(first, second) for first, second in pairs]  # type: ignore[attr-defined]
    except (TypeError, ValueError) as error:
        raise InvalidInput(f"a gait's pairs must look like {_PAIRS}, not {pairs!r}") from error
    return tuple(
        (_leg_number("a leg of pairs", first), _leg_number("a leg of pairs", second))
        for first, second in read
    )


def _groups_of_legs(groups: object) -> tuple[Group, ...]:
    try:
        read = [tuple(group) for group in groups]  # type: ignore[attr-defined]
    except TypeError as error:
        raise InvalidInput(f"a gait's groups must look like {_GROUPS}, not {groups!r}") from error
    return tuple(tuple(_leg_number("a leg of groups", leg) for leg in group) for group in read)


PAPER_GAITS: dict[str, GaitSpec] = {
    "left-right-origin": GaitSpec(1, 2, "origin"),
    "left-right-vertical": GaitSpec(1, 2, "vertical"),
    "front-back-origin": GaitSpec(1, 3, "origin"),
    "front-back-vertical": GaitSpec(1, 3, "vertical"),
}
"""The four gaits that the paper compares."""
NAMED_GAITS: dict[str, GaitSpec] = PAPER_GAITS | {
    name: GaitSpec(1, 2, groups=name) for name in get_args(Grouping)
}
GAIT_TITLES: Mapping[str, str] = {
    "left-right-origin": "Left-right, opposite",
    "left-right-vertical": "Left-right, mirrored",
    "front-back-origin": "Front-back, opposite",
    "front-back-vertical": "Front-back, mirrored",
    "tripod": "Tripod",
    "tetrapod": "Tetrapod",
    "trot": "Trot",
    "pace": "Pace",
    "bound": "Bound",
    "one-by-one": "One by one",
}
"""Display names of the named gaits."""


def read_gait(value: Any) -> str | GaitSpec:
    """Return a gait from user input: its name, or its legs with symmetry, pairs or groups.

    Raises:
        UnknownName, InvalidInput: if it is not a gait.
    """
    if isinstance(value, GaitSpec):
        return value
    if isinstance(value, str):
        gait_spec(value)
        return value
    if not isinstance(value, Mapping):
        raise InvalidInput(f"a gait is one of {', '.join(NAMED_GAITS)}, or its legs, not {value!r}")
    names = [field.name for field in fields(GaitSpec)]
    if set(value) - {*names} or not {"right_leg", "left_leg"} <= {*value}:
        raise InvalidInput(
            "a gait needs right_leg and left_leg, and one of symmetry, pairs and groups; "
            f"not {', '.join(map(str, sorted(value))) or 'nothing'}"
        )
    return GaitSpec(**{name: _whole(legs) for name, legs in value.items()})


def _whole(value: Any) -> Any:
    """Convert floats that are whole, as JSON does not distinguish 2.0 from 2."""
    if isinstance(value, list | tuple):
        return tuple(map(_whole, value))
    return int(value) if isinstance(value, float) and value.is_integer() else value


def gait_as_json(value: str | GaitSpec) -> str | dict[str, Any]:
    """Return a gait fit for JSON, the inverse of `read_gait`."""
    if isinstance(value, str):
        return value
    return {name: legs for name, legs in asdict(value).items() if legs is not None}


DEFAULT_GAIT = "left-right-origin"
"""The gait of a walk that names none, in every interface: the first of the paper's."""
_NAME: Schema = {"type": "string", "enum": list(NAMED_GAITS)}
_LEG: Schema = {"type": "integer", "minimum": 1, "maximum": MAX_LEGS}
_PAIR: Schema = {"type": "array", "prefixItems": [_LEG, _LEG], "minItems": 2, "maxItems": 2}
_OUTPUT: Schema = {
    "type": "object",
    "description": "A gait by its legs, with symmetry, pairs or groups.",
    "properties": {
        "right_leg": _LEG,
        "left_leg": _LEG,
        "symmetry": {"type": "string", "enum": list(get_args(Symmetry))},
        "pairs": {"type": "array", "items": _PAIR},
        "groups": {
            "anyOf": [
                {"type": "string", "enum": list(get_args(Grouping))},
                {"type": "array", "items": {"type": "array", "items": _LEG, "minItems": 1}},
            ]
        },
    },
    "required": ["right_leg", "left_leg"],
    "additionalProperties": False,
}
GAIT_SCHEMA: Schema = {
    **_OUTPUT,
    "oneOf": [{"required": [name]} for name in ("symmetry", "pairs", "groups")],
}
AnyGait = Annotated[
    str | GaitSpec,
    JsonForm(read_gait, gait_as_json, {"anyOf": [_NAME, GAIT_SCHEMA]}, {"anyOf": [_NAME, _OUTPUT]}),
]
"""A gait by its name, or by its legs."""


@dataclass(frozen=True)
class Gait:
    """A gait of one robot.

    Attributes:
        name: its name, or a description of a user's specification.
        forward_deg: the forward direction in the body frame, anticlockwise from body x.
        azimuths_deg: each leg's azimuth relative to forward, anticlockwise, in (−180, 180].
        groups: the legs that move together, counted from 1, in the order of the state vector. Each
            leg is in one group.
        mirror: for each leg 1 if its foot goes to (x, y) where its group does, −1 if to (−x, y), 0
            if to (0, y).

    Raises:
        InvalidInput: if a leg is in no group or in several, or there are less than two groups.
    """

    __repr__ = short_repr

    name: str
    forward_deg: float
    azimuths_deg: tuple[float, ...]
    groups: tuple[tuple[int, ...], ...]
    mirror: tuple[int, ...]

    def __post_init__(self) -> None:
        _check_partition(self.groups, len(self.azimuths_deg))

    @property
    def sizes(self) -> tuple[int, ...]:
        """Number of legs of each group."""
        return tuple(map(len, self.groups))

    @property
    def group_of_leg(self) -> tuple[int, ...]:
        """Index of the group of each leg."""
        numbered = [(leg, index) for index, group in enumerate(self.groups) for leg in group]
        return tuple(index for _, index in sorted(numbered))

    def by_leg(self, offsets_m: FloatArray) -> FloatArray:
        """Return each foot's offset (x, y) from home, (legs, 2), by those of the groups."""
        offsets = offsets_m[list(self.group_of_leg)]
        offsets[:, 0] *= self.mirror
        return offsets

    def by_group(
        self, feet_m: Sequence[Sequence[float]], lateral_m: Sequence[float]
    ) -> list[tuple[float, float]]:
        """Return each group's offset (x, y), the mean of its feet, from those of all feet [m].

        In plain floats, which are faster than arrays for so few numbers.

        Args:
            feet_m: offset of each foot.
            lateral_m: planned x of each group, which is taken where all feet stand on the axis:
                they do not move sideways, so that x cannot be measured.
        """
        mirror, offsets = self.mirror, []
        for group, planned in zip(self.groups, lateral_m, strict=True):
            x = y = 0.0
            sides = 0
            for leg in group:
                foot = feet_m[leg - 1]
                x += mirror[leg - 1] * foot[0]
                y += foot[1]
                sides += mirror[leg - 1] != 0
            offsets.append((x / sides if sides else planned, y / len(group)))
        return offsets

    @property
    def title(self) -> str:
        """The display name; a user's own gait keeps its name."""
        return GAIT_TITLES.get(self.name, self.name)


def gait_spec(gait: str | GaitSpec) -> GaitSpec:
    """Return the specification of a named gait; a specification is returned unchanged.

    Raises:
        UnknownName: if there is no gait of this name.
    """
    if isinstance(gait, GaitSpec):
        return gait
    if gait not in NAMED_GAITS:
        raise UnknownName("gait", gait, NAMED_GAITS)
    return NAMED_GAITS[gait]


def resolve(gait: str | GaitSpec, body_azimuths_deg: Sequence[float]) -> Gait:
    """Apply a gait to a robot with the given leg azimuths.

    Args:
        gait: a name of `NAMED_GAITS`, or a specification.
        body_azimuths_deg: each leg's azimuth in the body frame, anticlockwise from body x.

    Raises:
        UnknownName: if there is no gait of this name.
        InvalidInput: if a leg does not exist, has no mirror image, or is paired twice or never.
    """
    spec = gait_spec(gait)
    count = len(body_azimuths_deg)
    for leg in (spec.right_leg, spec.left_leg):
        _check_leg(leg, count)
    if spec.right_leg == spec.left_leg:
        raise InvalidInput(f"right_leg and left_leg are both {spec.right_leg}; name two legs")
    right, left = (body_azimuths_deg[leg - 1] for leg in (spec.right_leg, spec.left_leg))
    forward = right + ((left - right) % 360) / 2
    azimuths = tuple(_wrap(a - forward) for a in body_azimuths_deg)
    if spec.groups is not None:
        groups = spec.groups
        if isinstance(groups, str):
            groups = _groups_by(groups, azimuths)
        return Gait(_name(gait), _wrap(forward), azimuths, groups, tuple(map(_side, azimuths)))
    if spec.pairs is not None:
        pairs: tuple[Group, ...] = spec.pairs
    elif spec.symmetry == "origin":
        pairs = _origin_pairs(azimuths)
    else:
        pairs = _vertical_pairs(azimuths)
    leaders = {leader for leader, *partners in pairs if partners}
    partners = {partner for _, *partners in pairs for partner in partners}
    mirror = tuple((leg in leaders) - (leg in partners) for leg in range(1, count + 1))
    return Gait(_name(gait), _wrap(forward), azimuths, pairs, mirror)


def _name(gait: str | GaitSpec) -> str:
    if isinstance(gait, str):
        return gait
    for name, spec in NAMED_GAITS.items():
        if spec == gait:
            return name
    if isinstance(gait.groups, str):
        how: str = gait.groups
    else:
        groups = gait.pairs or gait.groups or ()
        how = gait.symmetry or " ".join("+".join(map(str, group)) for group in groups)
    return f"right {gait.right_leg}, left {gait.left_leg}, {how}"


def _wrap(angle_deg: float) -> float:
    """Wrap an angle to (−180, 180], rounded to 1e-9°, since azimuths are compared exactly."""
    wrapped = round((angle_deg + 180) % 360 - 180, 9)
    return 180.0 if wrapped == -180 else wrapped


def _leg_at(azimuth_deg: float, azimuths: Sequence[float], of_leg: int, symmetry: str) -> int:
    for leg, azimuth in enumerate(azimuths, start=1):
        if abs(_wrap(azimuth - azimuth_deg)) < _SAME_DIRECTION_DEG and leg != of_leg:
            return leg
    raise InvalidInput(
        f"leg {of_leg} has no partner under {symmetry} symmetry: no other leg stands at "
        f"{_wrap(azimuth_deg):g}° from forward; give the groups by hand"
    )


def _origin_pairs(azimuths: Sequence[float]) -> tuple[Pair, ...]:
    """Pair opposite legs; the lower number leads, in ascending order."""
    partners = {
        leg: _leg_at(a + 180, azimuths, leg, "origin") for leg, a in enumerate(azimuths, start=1)
    }
    return tuple((leg, partner) for leg, partner in partners.items() if leg < partner)


def _vertical_pairs(azimuths: Sequence[float]) -> tuple[Group, ...]:
    """Pair mirror images about the forward axis; the right leg leads.

    Pairs are ordered from front to back; a pair on the axis, or a leg alone there, comes last.
    """
    numbered = dict(enumerate(azimuths, start=1))
    right = [leg for leg, a in numbered.items() if -180 < a < 0]
    right.sort(key=lambda leg: -numbered[leg])
    pairs = [(leg, _leg_at(-numbered[leg], azimuths, leg, "vertical")) for leg in right]
    on_axis = sorted(
        (leg for leg, a in numbered.items() if a in (0, 180)), key=numbered.__getitem__
    )
    return (*pairs, *([tuple(on_axis)] if on_axis else []))


def _side(azimuth_deg: float) -> int:
    """Return on which side of the body a leg stands: 1 right, −1 left, 0 on the axis."""
    from_axis = min(abs(azimuth_deg), 180 - abs(azimuth_deg))
    if from_axis < _SAME_DIRECTION_DEG:
        return 0
    return 1 if azimuth_deg < 0 else -1


def _groups_by(grouping: Grouping, azimuths: Sequence[float]) -> tuple[Group, ...]:
    """Divide legs into groups by a rule; groups are ordered by their lowest leg.

    - `tripod`: of six legs around the body every other one.
    - `tetrapod`: four legs stand: of eight legs every other one, of six each right leg with the
      left one behind it, and the last with the first.
    - `trot`: every other leg around the body, so that diagonal legs move together.
    - `pace`: the legs of each side.
    - `bound`: the legs in front, and the others.
    - `one-by-one`: each leg alone.

    Raises:
        InvalidInput: if the rule does not apply to these legs.
    """
    legs = sorted(range(1, len(azimuths) + 1), key=lambda leg: azimuths[leg - 1] % 360)
    groups, problem = _GROUPINGS[grouping](legs, azimuths)
    if not problem and not all(groups):
        problem = "one of its two groups would have no leg"
    if problem:
        raise InvalidInput(
            f"{grouping} makes no sense for these legs: {problem}; give the groups by hand, such "
            f"as {_GROUPS}, or take one-by-one"
        )
    return tuple(sorted(tuple(sorted(group)) for group in groups))


_Divided = tuple[list[list[int]], str]
"""Groups of legs, and why the rule does not apply to these legs; "" if it does."""


def _every_other(legs: list[int], azimuths: Sequence[float]) -> _Divided:  # noqa: ARG001
    odd = f"every other leg moves, but this robot has an odd number, {len(legs)}"
    return [legs[::2], legs[1::2]], odd if len(legs) % 2 else ""


def _tripod(legs: list[int], azimuths: Sequence[float]) -> _Divided:
    groups, _ = _every_other(legs, azimuths)
    return groups, "" if len(legs) == 6 else f"it needs six legs, this robot has {len(legs)}"


def _tetrapod(legs: list[int], azimuths: Sequence[float]) -> _Divided:
    left, right = _sides(legs, azimuths)
    if len(left) == len(right) == 3 and len(legs) == 6:
        right.reverse()
        return [[leg, left[(place + 1) % 3]] for place, leg in enumerate(right)], ""
    groups, _ = _every_other(legs, azimuths)
    return groups, "" if len(legs) == 8 else "it needs eight legs, or three on each side"


def _pace(legs: list[int], azimuths: Sequence[float]) -> _Divided:
    left, right = _sides(legs, azimuths)
    on_axis = [leg for leg in legs if leg not in left + right]
    problem = f"leg {on_axis[0]} stands on the axis, on neither side" if on_axis else ""
    return [right, left], problem


def _bound(legs: list[int], azimuths: Sequence[float]) -> _Divided:
    front = [leg for leg in legs if abs(azimuths[leg - 1]) < 90 - _SAME_DIRECTION_DEG]
    return [front, [leg for leg in legs if leg not in front]], ""


def _one_by_one(legs: list[int], azimuths: Sequence[float]) -> _Divided:  # noqa: ARG001
    return [[leg] for leg in legs], ""


def _sides(legs: list[int], azimuths: Sequence[float]) -> tuple[list[int], list[int]]:
    """Return the left legs from front to back, and the right legs from back to front."""
    sides = {leg: _side(azimuths[leg - 1]) for leg in legs}
    left, right = ([leg for leg in legs if sides[leg] == side] for side in (-1, 1))
    return left, right


_GROUPINGS: Mapping[Grouping, Callable[[list[int], Sequence[float]], _Divided]] = {
    "tripod": _tripod,
    "tetrapod": _tetrapod,
    "trot": _every_other,
    "pace": _pace,
    "bound": _bound,
    "one-by-one": _one_by_one,
}
"""Function of each rule, which divides legs ordered anticlockwise from straight ahead."""


def _check_leg(leg: int, count: int) -> None:
    if not 1 <= leg <= count:
        raise InvalidInput(f"there is no leg {leg}; this robot has legs 1 to {count}")


def _check_partition(groups: Sequence[Sequence[int]], count: int) -> None:
    if not all(groups) or len(groups) < 2:
        raise InvalidInput(
            f"a gait has two groups of legs or more, each with a leg, not {len(groups)}: while one "
            "moves the others carry the body"
        )
    used = [leg for group in groups for leg in group]
    for leg in used:
        _check_leg(leg, count)
        if used.count(leg) > 1:
            raise InvalidInput(f"leg {leg} is used {used.count(leg)} times in the groups, not once")
    for leg in range(1, count + 1):
        if leg not in used:
            raise InvalidInput(f"the groups leave out leg {leg}; each leg belongs to one group")
