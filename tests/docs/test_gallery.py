"""Each picture of the gallery is there, and is a link to a state that the page can have."""

import re
from collections.abc import Callable, Mapping
from urllib.parse import parse_qsl, urlsplit

import pytest

import hexapods as hx
from hexapods.agents.registry import find, settings_of
from hexapods.arguments import read_disturbance, read_robot, read_walk
from hexapods.domain.gait import read_gait
from hexapods.domain.observation import check_observation
from hexapods.runs.race_config import RaceConfig
from tests.docs.programs import DOCS

PICTURE = re.compile(r"^\[!\[[^]]+\]\((?P<file>[^)]+)\)\]\((?P<link>[^)]+)\)$", re.MULTILINE)
PICTURES = [
    match.group("file", "link")
    for match in PICTURE.finditer((DOCS / "gallery.md").read_text("utf-8"))
]
PAGE = (DOCS / "page.md").read_text("utf-8")


def word(parameter: str) -> Callable[[str], object]:
    """Return the check of a parameter of which docs/page.md lists the values."""
    [row] = re.findall(rf"^\| `{parameter}`(?:, `\w+`)* \| (.+) \|$", PAGE, re.MULTILINE)
    return re.findall(r"`([\w-]+)`", row).index


def check_tried(text: str) -> None:
    """Check settings of the learner that *What if* tries."""
    settings = settings_of(find("q-learning"))
    for name, value in (pair.split("=") for pair in text.split(",")):
        settings[name].normalized(float(value))


CHECKS: Mapping[str, Callable[[str], object]] = {
    "depth": word("depth"),
    "tab": word("tab"),
    "gait": read_gait,
    "robot": read_robot,
    "observation": check_observation,
    "race_steps": int,
    "disturb": read_disturbance,
    "lanes": lambda text: [find(name) for name in text.split(",")],
    "tried": check_tried,
}


def test_every_picture_is_one_of_the_repository_and_all_are_links() -> None:
    text = (DOCS / "gallery.md").read_text("utf-8")
    assert len(PICTURES) == text.count("![") == 5
    assert [file for file, _ in PICTURES if not (DOCS / file).is_file()] == []


@pytest.mark.parametrize("link", [link for _, link in PICTURES])
def test_the_link_of_a_picture_is_a_state_of_the_page(link: str) -> None:
    address = urlsplit(link)
    assert address.netloc == "127.0.0.1:8000"
    assert address.path == "/" or f"`{address.path}`" in PAGE
    state = dict(parse_qsl(address.query, strict_parsing=bool(address.query)))
    for name, text in state.items():
        CHECKS[name](text)
    walk: dict[str, object] = {name: state[name] for name in ("gait", "robot") if name in state}
    if "lanes" in state:
        RaceConfig(
            **read_walk(walk | {"world": [state[name] for name in ("disturb",) if name in state]}),
            lanes=tuple(hx.lane(name).config for name in state["lanes"].split(",")),
            steps=int(state.get("race_steps", "50")),
        )
