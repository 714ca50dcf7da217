"""The guide: the project's documentation as pages of this server, which needs no network."""

import re
from collections.abc import Collection, Mapping, Sequence
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

from markupsafe import Markup
from starlette.requests import Request
from starlette.responses import HTMLResponse, RedirectResponse, Response
from starlette.routing import BaseRoute

from app.api.policy import WATCH, GuardedPage, policy
from app.api.problems import problem
from app.api.templates import render
from hexapods.version import __version__

if TYPE_CHECKING:
    from markdown_it.token import Token

FIRST = "page"
"""Name of the page to which the address of the guide leads."""
_PAGE = re.compile(r"((?P<name>[\w-]+)\.md)?(?P<part>#[\w-]+)?")
_ELSEWHERE = re.compile(r"https?://.+")
_NOT_IN_SLUG = re.compile(r"[^\w\- ]")
_PART = re.compile(r"^```\{toctree\}\n:caption: (?P<caption>.+)\n(?P<lines>[^`]*)", re.MULTILINE)
_NAME = re.compile(r"[\w-]+")


@cache
def contents(folder: Path) -> Mapping[str, Sequence[str]]:
    """Return the names of the pages by part, as the index of the documentation has them.

    Left out is what only its site has: references that are written from the code, and subfolders.

    Args:
        folder: folder of the documentation, in Markdown.
    """
    index = (folder / "index.md").read_text("utf-8")
    return {
        part["caption"]: [
            name
            for name in part["lines"].splitlines()
            if _NAME.fullmatch(name) and (folder / f"{name}.md").is_file()
        ]
        for part in _PART.finditer(index)
    }


@cache
def names_of(folder: Path) -> frozenset[str]:
    """Return the names of all pages."""
    return frozenset(name for names in contents(folder).values() for name in names)


def guide_routes(folder: Path) -> list[BaseRoute]:
    """Return the routes `/guide/{name}`, and `/guide`, which leads to the first page.

    Args:
        folder: folder of the documentation, in Markdown.
    """

    @policy(access=WATCH)
    def show(request: Request) -> Response:
        name = request.path_params["name"]
        if name not in names_of(folder):
            names = ", ".join(sorted(names_of(folder)))
            return problem(404, f"The guide has no page {name!r}; it has {names}.")
        return HTMLResponse(_page(folder, name))

    @policy(access=WATCH)
    def first(request: Request) -> Response:
        del request
        # Relative, so that it is valid behind a proxy that serves the app under a prefix.
        return RedirectResponse(f"guide/{FIRST}")

    return [
        GuardedPage("/guide", first, name="guide_start"),
        GuardedPage("/guide/{name}", show, name="guide"),
    ]


@cache
def _page(folder: Path, name: str) -> str:
    # Its import takes 0.1 s, and most servers show no page of the guide.
    from markdown_it import MarkdownIt  # noqa: PLC0415

    markdown = MarkdownIt("commonmark", {"html": False}).enable("table")
    tokens = markdown.parse((folder / f"{name}.md").read_text("utf-8"))
    shown = [token for token in tokens if not _is_directive(token)]
    _add_anchors(shown)
    for token in shown:
        if token.children:
            token.children = _linked(token.children, name, names_of(folder))
    body = markdown.renderer.render(shown, markdown.options, {})
    return render(
        "guide.html",
        Path(__file__).parent,
        title=_title(folder, name),
        name=name,
        contents=[
            (heading, [(page, _title(folder, page)) for page in names])
            for heading, names in contents(folder).items()
        ],
        body=Markup(body),  # noqa: S704 - of files of the project, whose HTML is escaped
        version=__version__,
    )


@cache
def _title(folder: Path, name: str) -> str:
    first = (folder / f"{name}.md").read_text("utf-8").partition("\n")[0]
    return first.removeprefix("# ")


def _is_directive(token: "Token") -> bool:
    """Whether a token is a directive of Sphinx, which only its site shows."""
    return token.type == "fence" and token.info.startswith("{")


def _add_anchors(tokens: list["Token"]) -> None:
    """Give headings the ids that links to them have."""
    for token, inline in pairwise(tokens):
        if token.type == "heading_open":
            words = _NOT_IN_SLUG.sub("", inline.content.lower())
            token.attrSet("id", words.replace(" ", "-"))


def _linked(tokens: list["Token"], name: str, names: Collection[str]) -> list["Token"]:
    """Rewrite links between documents to pages of the guide; drop pictures and links to files.

    Args:
        tokens: inline tokens of a page.
        name: of this page.
        names: of all pages.
    """
    for token in tokens:
        if token.type != "link_open":
            continue
        href = str(token.attrGet("href") or "")
        page = _PAGE.fullmatch(href)
        if page and (page["name"] or name) in names:
            token.attrSet("href", f"{page['name'] or name}{page['part'] or ''}")
        elif not _ELSEWHERE.fullmatch(href):  # a file of the repository
            token.attrs.pop("href", None)
    shown: list[Token] = []
    for token in tokens:
        if token.type == "link_close" and shown and shown[-1].type == "link_open":
            shown.pop()  # a link of a picture alone
        elif token.type != "image":
            shown.append(token)
    return shown
