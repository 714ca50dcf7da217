"""Codes of rooms, and names of participants from a list of words."""

from collections.abc import Callable, Collection, Sequence

ALPHABET = "ABCDEFGHJKLMNPQRSTUVWXYZ23456789"
"""Without O and 0, I and 1, which look alike on a projector."""
CODE_LENGTH = 8
"""Letters of a code: too many to guess it by trying, so that no rate limit is needed, which one
pupil would use up for all of a class that shares an address."""
CODE = f"[{ALPHABET}]{{{CODE_LENGTH}}}"
"""Regular expression of a code."""
Choose = Callable[[Sequence[str]], str]
"""Chooses one of several at random."""
_FIRST = (
    *("Amber", "Azure", "Brave", "Bright", "Brisk", "Calm", "Clever", "Coral", "Crisp", "Daring"),
    *("Eager", "Early", "Fair", "Fleet", "Fresh", "Gentle", "Golden", "Green", "Happy", "Ivory"),
    *("Jolly", "Keen", "Kind", "Lively", "Lucky", "Merry", "Mighty", "Neat", "Noble", "Olive"),
    *("Patient", "Polite", "Proud", "Quick", "Quiet", "Rapid", "Ready", "Royal", "Ruby", "Sandy"),
    *("Silver", "Smart", "Snowy", "Steady", "Sunny", "Swift", "Teal", "Tidy", "Violet", "Warm"),
)
_SECOND = (
    *("Ant", "Badger", "Beaver", "Bee", "Beetle", "Bison", "Crane", "Cricket", "Deer", "Dolphin"),
    *("Eagle", "Falcon", "Finch", "Fox", "Gecko", "Hare", "Hawk", "Heron", "Ibex", "Jay"),
    *("Koala", "Lark", "Lemur", "Lizard", "Lynx", "Marten", "Mole", "Moose", "Newt", "Ocelot"),
    *("Otter", "Owl", "Panda", "Parrot", "Penguin", "Puffin", "Quail", "Raven", "Robin", "Salmon"),
    *("Seal", "Sparrow", "Stork", "Swan", "Tern", "Tiger", "Toucan", "Turtle", "Whale", "Wren"),
)


def new_code(choose: Choose, taken: Collection[str]) -> str:
    """Return the code of a new room, which no other has."""
    while True:
        code = "".join(choose(ALPHABET) for _ in range(CODE_LENGTH))
        if code not in taken:
            return code


def normalized(code: str) -> str:
    """Return a code as it is stored, however it was typed: with a gap, a hyphen, small letters."""
    return "".join(letter for letter in code.upper() if letter.isalnum())


def in_groups(code: str) -> str:
    """Return a code in two groups with a hyphen between them, as it is in addresses."""
    half = len(code) // 2
    return f"{code[:half]}-{code[half:]}"


def new_name(choose: Choose, taken: Collection[str]) -> str:
    """Return the name of a new participant, which no other has of the room's."""
    while True:
        name = f"{choose(_FIRST)} {choose(_SECOND)}"
        if name not in taken:
            return name
