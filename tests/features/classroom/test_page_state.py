"""The page's state that cards may set is that of the page and of its features."""

import re
from dataclasses import fields
from typing import get_args, get_type_hints

from app.api.deps import PageFiles
from app.api.pages import page_features
from app.features.classroom.page_state import Depth, PageState, Tab
from hexapods import assets

SOURCE = (assets.static_dir() / "js" / "page-state.js").read_text("utf-8")
FEATURES = page_features(PageFiles(assets.static_dir()))


def words(name: str) -> list[str]:
    """Return the words of a constant of the page."""
    match = re.search(rf"const {name} = \[(.*?)\];", SOURCE)
    assert match is not None
    return re.findall(r'"([^"]+)"', match[1])


def added(member: str) -> list[str]:
    """Return what features add to a member of the page."""
    return [name for feature in FEATURES for name in feature.get(member, ())]


def test_each_field_is_one_of_the_page() -> None:
    block = SOURCE[SOURCE.index("const FIELDS = {") :]
    fields_of_page = re.findall(r"^  (\w+): \{ part:", block, flags=re.MULTILINE)
    assert {"view", "hidden", "selected"} <= set(fields_of_page)
    assert {field.name for field in fields(PageState)} <= {*fields_of_page, *added("fields")}


def test_words_are_those_of_the_page() -> None:
    assert list(get_args(Depth)) == words("DEPTHS")
    assert sorted(get_args(Tab)) == sorted(words("TABS") + added("tabs"))
    hidden = get_type_hints(PageState)["hidden"]
    assert set(get_args(get_args(hidden)[0])) == {*words("HIDEABLE"), *added("hideable")}
