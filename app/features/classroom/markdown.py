"""The texts of lessons: lines, and Markdown without HTML, pictures and links that run scripts."""

from functools import cache, lru_cache
from typing import TYPE_CHECKING, Annotated, Any
from urllib.parse import urlsplit

from annotated_types import MaxLen, MinLen

from hexapods.domain.errors import InvalidInput
from hexapods.domain.text import visible

if TYPE_CHECKING:
    from markdown_it import MarkdownIt

MAX_TEXT = 8_000
"""Characters of a text of a card."""
MAX_SHORT = 300
"""Characters of a title, an aim or a choice of an answer."""
Title = Annotated[str, MinLen(1), MaxLen(MAX_SHORT)]
Markdown = Annotated[str, MaxLen(MAX_TEXT)]
_SCHEMES = ("http", "https", "mailto")


def check_line(where: str, text: str) -> None:
    """Check a title, an aim or a choice, which is no Markdown.

    Args:
        where: name of the field, for the message.
        text: what it says.

    Raises:
        InvalidInput: if it is no line that can be seen.
    """
    if visible(text) != text or not text.strip():
        raise InvalidInput(
            f"{where} must be one line of text of at most {MAX_SHORT} characters, without control "
            "characters or other invisible characters"
        )


def check_markdown(text: str, where: str) -> None:
    """Check that a text has nothing that a page may not show.

    Args:
        text: in Markdown (CommonMark, and tables).
        where: name of the field, for the message.

    Raises:
        InvalidInput: if it has HTML, a picture, or a link to something else than a page.
    """
    for token in _tokens(_parser(True).parse(text)):
        if token.type in ("html_block", "html_inline"):
            raise InvalidInput(
                f"{where} has HTML, {_beginning(token.content)}; a text is Markdown alone, in "
                "which a < of its own is written as &lt;"
            )
        if token.type == "image":
            raise InvalidInput(f"{where} has a picture, and texts of lessons have none")
        address = str(token.attrGet("href") or "") if token.type == "link_open" else ""
        if (scheme := _scheme(address)) not in ("", *_SCHEMES):
            raise InvalidInput(
                f"{where} has a link with {scheme}:; links begin with {', '.join(_SCHEMES)}, or "
                "lead to a page of this server"
            )


@lru_cache(maxsize=2048)
def as_html(text: str) -> str:
    """Return a text that was checked as HTML; what is left of HTML in it is shown as text."""
    return str(_parser(False).render(text))


def _scheme(address: str) -> str:
    try:
        return urlsplit(address).scheme.lower()
    except ValueError:
        return "what is no address"


@cache
def _parser(has_html: bool) -> "MarkdownIt":
    # Its import takes 0.1 s, and a server without lessons needs none.
    from markdown_it import MarkdownIt  # noqa: PLC0415

    return MarkdownIt("commonmark", {"html": has_html}).enable("table")


def _tokens(tokens: list[Any]) -> list[Any]:
    return [token_ for token in tokens for token_ in (token, *_tokens(token.children or []))]


def _beginning(text: str) -> str:
    text = " ".join(text.split())
    return repr(text if len(text) <= 40 else f"{text[:40]}…")
