"""Builds `docs/` as a site: `make docs`. The references are written from the code at each build."""

import contextlib
import io
import re
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx

import hexapods
from app.cli import main
from app.cli.commands import command_paths
from app.server import create_app
from app.settings import Settings
from app.storage.database.opening import open_store

project = "Racing Hexapods"
release = version = hexapods.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
html_theme = "furo"
html_title = f"Racing Hexapods {version}"
html_static_path = ["site.css"]
html_css_files = ["site.css"]
exclude_patterns = ["reproduction", "notebooks"]
source_suffix = {".md": "markdown"}
myst_heading_anchors = 3
myst_enable_extensions = ["colon_fence"]
autodoc_typehints = "description"
autodoc_member_order = "bysource"
napoleon_google_docstring = True

_GENERATED = Path(__file__).parent / "_generated"


def setup(site: Sphinx) -> None:
    """Write the references before the site is read, and `llms.txt` when it is built."""
    site.connect("builder-inited", lambda _: _write_references())
    site.connect("build-finished", _write_contents)


def _write_references() -> None:
    _write("rest.md", _rest())
    _write("commands.md", _commands())


def _write(name: str, lines: Iterator[str]) -> None:
    text = "\n".join(lines) + "\n"
    path = _GENERATED / name
    path.parent.mkdir(exist_ok=True)
    # Unchanged, so that the next build reads it again only if the code has changed.
    if not path.exists() or path.read_text("utf-8") != text:
        path.write_text(text, "utf-8")


def _write_contents(site: Sphinx, error: Exception | None) -> None:
    """Write `llms.txt` (llmstxt.org): title, summary, and pages by part, as the index has them."""
    if error is None and site.builder.format == "html":
        path = Path(site.outdir) / "llms.txt"
        path.write_text("\n".join(_contents(site)) + "\n", "utf-8")


def _contents(site: Sphinx) -> Iterator[str]:
    index = site.env.get_doctree(site.config.root_doc)
    yield f"# {project}\n"
    yield f"> {_summary(index)}"
    for tree in index.findall(addnodes.toctree):
        yield f"\n## {tree['caption']}\n"
        for _, name in tree["entries"]:
            title = site.env.titles[name].astext()
            summary = _summary(site.env.get_doctree(name))
            address = site.builder.get_relative_uri(site.config.root_doc, name)
            yield f"- [{title}]({address}){f': {summary}' if summary else ''}"


def _summary(page: nodes.document) -> str:
    """Return the first sentence of a page; "" if it begins with none."""
    paragraph = next(iter(page.findall(nodes.paragraph)), None)
    text = "" if paragraph is None else " ".join(paragraph.astext().split())
    sentence = re.match(r".+?[.:](?= [A-Z]|$)", text)
    return text if sentence is None else sentence[0]


def _rest() -> Iterator[str]:
    yield "# REST"
    yield ""
    yield (
        "All addresses are below that of the server, whose API documentation is at `/docs` and "
        "`/openapi.json`. Errors are problem documents (RFC 9457), and each says what is valid."
    )
    with TemporaryDirectory() as folder:
        settings = Settings(data=Path(folder))
        with open_store(settings) as store:
            document: dict[str, Any] = create_app(settings, store).openapi()
    by_tag: dict[str, list[tuple[str, str, dict[str, Any]]]] = {}
    for path, methods in document["paths"].items():
        for method, operation in methods.items():
            if "summary" in operation:
                tag = operation.get("tags", ["server"])[0]
                by_tag.setdefault(tag, []).append((method, path, operation))
    for tag, operations in by_tag.items():
        yield f"\n## {tag.capitalize()}"
        for method, path, operation in operations:
            yield from _operation(method, path, operation)


def _operation(method: str, path: str, operation: dict[str, Any]) -> Iterator[str]:
    yield f"\n### {operation['summary']}\n"
    yield f"`{method.upper()} {path}`\n"
    yield operation.get("description", "")
    parameters = [parameter for parameter in operation.get("parameters", ()) if "name" in parameter]
    if parameters:
        yield "\n| parameter | in | meaning |\n|---|---|---|"
        for parameter in parameters:
            description = _cell(parameter.get("description", ""))
            yield f"| `{parameter['name']}` | {parameter['in']} | {description} |"


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")


def _commands() -> Iterator[str]:
    yield "# Commands"
    for name in command_paths():
        shown = io.StringIO()
        with contextlib.redirect_stdout(shown), contextlib.suppress(SystemExit):
            main([name, "--help"])
        yield f"\n## {name}\n"
        yield f"```text\n{shown.getvalue().rstrip()}\n```"
