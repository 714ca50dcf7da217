"""Parts of an HTML file that opens without a server: modules and styles of the page, and data.

Modules are `data:` addresses in an import map. The Content-Security-Policy of such a file lets it
load nothing else, and run only those modules that an element with the file's nonce imports.
"""

import base64
import hashlib
import json
import posixpath
import re
from collections.abc import Mapping
from functools import cache
from html.parser import HTMLParser
from typing import Any

from hexapods import assets

_IMPORT = re.compile(
    r"""(?P<before>(?:^|;)import\b[^"'`;()]*|(?:^|;)export\b[^"'`;()=]*\bfrom\s*|(?<=\s)import\()"""
    r'"(?P<name>[^"\n]+)"',
    re.MULTILINE,
)
"""The module that a statement imports or exports from, or that code imports when it needs it."""


@cache
def import_map(entry: str) -> str:
    """Return an import map that has a module and all that it imports as `data:` addresses.

    Modules keep their paths below `static` as names, without a dot or slash at the beginning, so
    that they are no addresses.

    Args:
        entry: path of the module below `static`.
    """
    sources: dict[str, str] = {}
    waiting = [entry]
    packages = _packages()
    while waiting:
        path = waiting.pop()
        if path in sources:
            continue
        text = _sent_text(path)

        def renamed(match: re.Match[str], path: str = path) -> str:
            imported = _path_of(match["name"], path, packages)
            waiting.append(imported)
            return f'{match["before"]}"{imported}"'

        sources[path] = _IMPORT.sub(renamed, text)
    imports = {
        path: f"data:text/javascript;base64,{base64.b64encode(text.encode()).decode()}"
        for path, text in sorted(sources.items())
    }
    return json.dumps({"imports": imports})


def styles(*names: str) -> str:
    """Return style sheets below `static`, one after the other, without comments."""
    return "\n".join(map(_sent_text, names))


def _sent_text(path: str) -> str:
    file = assets.static_dir() / path
    return assets.as_sent(file, file.read_bytes()).decode()


def data_block(name: str, data: Mapping[str, Any] | bytes) -> str:
    """Return an element that holds data as JSON, or bytes in base64; browsers do not run its type.

    Args:
        name: id of the element.
        data: plain types without NaN and infinities, or bytes.

    Raises:
        ValueError: if there is a NaN or an infinity.
    """
    if isinstance(data, bytes):
        text = base64.b64encode(data).decode()
    else:
        # "<" could end the element.
        text = json.dumps(data, allow_nan=False).replace("<", "\\u003c")
    return f'<script type="text/plain" id="{name}">{text}</script>'


def digest(text: str) -> str:
    """Return the SHA-256 of a text in base64, for a Content-Security-Policy.

    That of all that a file has is its nonce: the same content gives the same file, and no data in
    it can name the nonce.
    """
    return base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


def _path_of(name: str, importer: str, packages: dict[str, str]) -> str:
    if name in packages:
        return packages[name]
    return posixpath.normpath(posixpath.join(posixpath.dirname(importer), name))


def _packages() -> dict[str, str]:
    """Return the paths of packages below `static`, from the page's own import map."""
    parser = _ImportMapParser()
    parser.feed((assets.static_dir() / "index.html").read_text("utf-8"))
    imports = json.loads(parser.text)["imports"]
    return {name: address.removeprefix("./static/") for name, address in imports.items()}


class _ImportMapParser(HTMLParser):
    """Finds the text of the import map of a page."""

    text = ""
    _is_inside = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self._is_inside = tag == "script" and ("type", "importmap") in attrs

    def handle_data(self, data: str) -> None:
        if self._is_inside:
            self.text += data
            self._is_inside = False
