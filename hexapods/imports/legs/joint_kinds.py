"""Names the joints of all legs alike, by what their names in the file have in common."""

import re
from collections.abc import Sequence

_PLAIN_WORDS = frozenset({"", "joint", "jnt", "link", "leg", "j", "motor", "servo"})
_MAX_JOINT_NAME = 24
Names = list[tuple[str, ...]]


def joint_kinds(names: Sequence[Sequence[str]]) -> Names:
    """Return names of the joints of each leg that tell their kind, the same for all legs.

    Of `FL_hip_joint` and `RR_hip_joint` the name is `hip`: the words that all legs have in common.
    Where there are none, or two joints would have one name, joints are numbered.
    """
    kinds_of_legs: Names = []
    for leg in names:
        alike = [other for other in names if len(other) == len(leg)]
        kinds = []
        for place, name in enumerate(leg):
            common = set.intersection(*({*_words(other[place])} for other in alike))
            words = [word for word in _words(name) if word in common and word not in _PLAIN_WORDS]
            kind = "_".join(words)[:_MAX_JOINT_NAME]
            kinds.append(f"joint{kind}" if kind.isdecimal() else kind)
        if not all(kinds) or len(set(kinds)) < len(kinds) or len(alike) < 2:
            kinds = [f"joint{place}" for place in range(1, len(leg) + 1)]
        kinds_of_legs.append(tuple(kinds))
    return kinds_of_legs


def _words(name: str) -> list[str]:
    apart = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name)
    return re.split(r"[^a-z0-9]+", apart.lower())
