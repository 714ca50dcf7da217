"""Links within the built site, to pages, parts of pages and files: `make docs` checks them.

    python -m tests.docs.site_links build/docs             # fails with the links that lead nowhere
    python -m tests.docs.site_links build/docs --external  # counts those to other sites, by host

Nothing is fetched.
"""

import re
import sys
from collections import Counter
from collections.abc import Iterator, Mapping
from html.parser import HTMLParser
from pathlib import Path
from typing import NamedTuple
from urllib.parse import unquote, urlsplit

_LINKS = {"a": "href", "img": "src", "link": "href", "script": "src", "source": "src"}
"""The attribute with the address, by element."""
_IN_MARKDOWN = re.compile(r"\]\(([^)]+)\)")
_TOP = "top"
"""The part of each page that is its beginning (HTML, 7.4.6.4)."""


class Page(NamedTuple):
    """Addresses in a page, and its parts."""

    links: frozenset[str]
    parts: frozenset[str]


class _Reader(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.links: set[str] = set()
        self.parts = {"", _TOP}

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = dict(attrs)
        self.parts |= {value for name in ("id", "name") if (value := values.get(name))}
        link = values.get(_LINKS.get(tag, ""))
        if link is not None:
            self.links.add(link)


def read_site(folder: Path) -> Mapping[Path, Page]:
    """Return the pages of a site, and its `llms.txt`, by their absolute paths.

    Raises:
        ValueError: if there are none.
    """
    contents = folder.resolve() / "llms.txt"
    if not contents.exists():
        raise ValueError(f"{folder} has no llms.txt; `make docs` builds a site in build/docs")
    links = _IN_MARKDOWN.findall(contents.read_text("utf-8"))
    pages = {contents: Page(frozenset(links), frozenset())}
    for path in sorted(folder.resolve().rglob("*.html")):
        reader = _Reader()
        reader.feed(path.read_text("utf-8"))
        pages[path] = Page(frozenset(reader.links), frozenset(reader.parts))
    return pages


def broken_links(folder: Path) -> Iterator[str]:
    """Yield a sentence for each link to a page, a part of a page or a file that is not there."""
    pages, root = read_site(folder), folder.resolve()
    for path, page in pages.items():
        for link in sorted(page.links):
            address = urlsplit(link)
            if address.scheme or address.netloc:
                continue
            target = path if not address.path else (path.parent / unquote(address.path)).resolve()
            place = f"{path.relative_to(root)} links to {link}"
            if target.is_dir():
                target /= "index.html"
            if not target.is_relative_to(root) or not target.exists():
                yield f"{place}, and there is no such file"
            elif target in pages and unquote(address.fragment) not in pages[target].parts:
                yield f"{place}, and {target.relative_to(root)} has no such part"


def external_links(folder: Path) -> Counter[str]:
    """Return how many different addresses of other sites there are, by host."""
    addresses = {link for page in read_site(folder).values() for link in page.links}
    return Counter(netloc for link in addresses if (netloc := urlsplit(link).netloc))


def main(folder: str, *options: str) -> int:
    """Print the links that lead nowhere, or count those to other sites; return the exit code."""
    if options == ("--external",):
        counts = external_links(Path(folder))
        for host, count in counts.most_common():
            print(f"{count:5} {host}")
        print(f"{counts.total():5} addresses of other sites, of which none was opened")
        return 0
    broken = list(broken_links(Path(folder)))
    print(*broken, sep="\n", end="\n" if broken else "")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
