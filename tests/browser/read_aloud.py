"""The page as a screen reader reads it: its accessibility tree, in order, as lines of text."""

from collections.abc import Sequence
from typing import Any, NamedTuple

from playwright.sync_api import Page

_SAID_FIRST = {
    "heading": "heading",
    "tab": "tab",
    "button": "button",
    "status": "status",
    "region": "region",
    "complementary": "landmark",
    "table": "table",
    "image": "picture",
    "slider": "slider",
}
"""Roles that are said before a name; those of texts, cells and what only groups are not."""
_NAMED_WHOLE = {"heading", "tab", "button", "image", "rowheader", "cell", "columnheader", "slider"}
"""Roles whose name says all that is in them."""
_TEXT = "StaticText"


class _Said(NamedTuple):
    text: str
    is_text: bool
    """Whether it is read on with the text before it, as words in bold are."""


def read_aloud(page: Page) -> list[str]:
    """Return what a screen reader says of a page from its beginning to its end.

    Each line is a role and a name, or a text; the cells of a row are one line, with commas between
    them.
    """
    session = page.context.new_cdp_session(page)
    nodes: list[dict[str, Any]] = session.send("Accessibility.getFullAXTree")["nodes"]
    session.detach()
    by_id = {node["nodeId"]: node for node in nodes}
    root = next(node for node in nodes if "parentId" not in node)
    return [said.text for said in _node(root, by_id)]


def _node(node: dict[str, Any], by_id: dict[str, dict[str, Any]]) -> list[_Said]:
    role = "" if node.get("ignored") else node["role"]["value"]
    name = " ".join(str(node.get("name", {}).get("value", "")).split())
    if role == _TEXT:
        return [_Said(name, is_text=True)] if name else []
    inner = [] if role in _NAMED_WHOLE else _children(node, by_id)
    if role == "row":
        return [_Said(", ".join(said.text for said in inner), is_text=False)] if inner else []
    if role in _SAID_FIRST:
        return [_Said(f"{_SAID_FIRST[role]}: {name}".rstrip(), is_text=False), *_ended(inner)]
    if role in _NAMED_WHOLE:
        return [_Said(name, is_text=False)] if name else []
    return _ended(inner) if role == "paragraph" else inner


def _ended(inner: Sequence[_Said]) -> list[_Said]:
    return [said._replace(is_text=False) for said in inner]


def _children(node: dict[str, Any], by_id: dict[str, dict[str, Any]]) -> list[_Said]:
    """Return what is said of the nodes in a node, texts that follow each other as one."""
    inner: list[_Said] = []
    for child in node.get("childIds", ()):
        for said in _node(by_id[child], by_id) if child in by_id else ():
            if said.is_text and inner and inner[-1].is_text:
                inner[-1] = _Said(f"{inner[-1].text} {said.text}", is_text=True)
            else:
                inner.append(said)
    return inner
