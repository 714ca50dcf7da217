"""The dashboard: its page and static files, compressed, with a content security policy."""

import base64
import hashlib
import html
import json
import mimetypes
import os
import posixpath
import re
from collections.abc import Callable, Mapping, Sequence
from datetime import timedelta
from pathlib import Path
from typing import Any

from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import BaseRoute
from starlette.staticfiles import PathLike, StaticFiles
from starlette.types import Scope

from app.api.compression import CompressedContent
from app.api.deps import PageFiles, Services
from app.api.descriptions import as_sentence
from app.api.policy import ANY_PAGE, PUBLIC, WATCH, GuardedFiles, GuardedPage, RoutePolicy, policy
from app.api.problem_pages import prefers_html
from app.api.problems import problem
from app.storage.errors import NotFound
from hexapods.assets import as_sent

_INLINE_SCRIPT = re.compile(
    r"<script(?![^>]*\ssrc=|[^>]*application/json)[^>]*>(.*?)</script>", re.DOTALL
)
_FEATURES = '<script type="application/json" id="features">[]</script>'
_PARTS = ("text/javascript", "text/css")
"""Media types of what a page loads, and a browser does not show by itself."""
_POLICY_OF_PARTS = {"Content-Security-Policy": "default-src 'none'; frame-ancestors 'self'"}
"""Shorter than that of other files: a first visit loads some sixty of them."""
"""They are for who reads the sources, and more than a kilobyte of a first visit."""
_INDEX = "index.html"
_HTML = '<html lang="en"'
"""How the first element of each page begins: its sources are in English."""
_TITLE = "<title>Racing Hexapods</title>"
VIEWS: Mapping[str, str] = {"runs": "Runs", "compare": "Compare runs"}
"""Titles of the core's views, beside that of the race, by their names; features add theirs."""
_COMMON = re.compile(r"<!-- common -->\n(.*?)<!-- /common -->\n", re.DOTALL)
_COMMON_OF_INDEX = "<!-- common: that of index.html -->\n"
_IMPORT_MAP = re.compile(r'<script type="importmap">(.*?)</script>', re.DOTALL)
_ENTRY = re.compile(r'<script type="module" src="((?:\.\./)*)([^"]+)"></script>')
# As all modules write it: at the start of a line, with a relative path in double quotes.
_IMPORT = re.compile(r'^import [^"]*"(\.[^"]+)";', re.MULTILINE)


def page_routes(page_files: PageFiles) -> list[BaseRoute]:
    """Return the routes of the page at `/`, of its views, and of its files under `/static/`.

    Each view has an address, as `/runs`: the same page beside the others, which opens the view.

    Args:
        page_files: folders of the files.
    """
    page = _page(_INDEX, page_files)
    languages = languages_of(page_files.folder)
    index = PageContent(page, languages)
    titles = view_titles(page_features(page_files))
    views = {
        name: PageContent(_opening(page, name, title), languages) for name, title in titles.items()
    }
    left_out = [page_files.folder / "features" / name for name in page_files.without]
    files = _Files(page_files.folder, left_out)
    public = RoutePolicy(access=PUBLIC)

    @policy(access=PUBLIC, opens_session=True)
    async def show(request: Request) -> Response:
        return index.response(request.scope)

    @policy(access=PUBLIC, opens_session=True)
    async def show_view(request: Request) -> Response:
        return views[request.url.path.rpartition("/")[2]].response(request.scope)

    @policy(access=ANY_PAGE)
    async def favicon(request: Request) -> Response:
        return await files.get_response("favicon.svg", request.scope)

    return [
        GuardedPage("/", show, name="dashboard"),
        *(GuardedPage(f"/{name}", show_view, name=f"view_{name}") for name in views),
        GuardedPage("/favicon.ico", favicon, name="favicon"),
        GuardedPage("/robots.txt", robots_txt, name="robots_txt"),
        # The page's files are public; the data they show is not.
        *(
            GuardedFiles(f"/static/features/{name}", _Files(folder), public)
            for name, folder in page_files.added.items()
        ),
        GuardedFiles("/static", files, public, name="static"),
    ]


def page_content(name: str, page_files: PageFiles) -> "PageContent":
    """Return a page of the dashboard's folder, with preloads and a content security policy."""
    return PageContent(_page(name, page_files), languages_of(page_files.folder))


class PageContent:
    """A page in English and in each language that it is translated to, compressed once.

    The texts are translated by the page's scripts (`static/js/translation.js`). The HTML differs by
    the attribute `lang`, by which they know the language, and by a preload of the catalogue.
    """

    def __init__(self, page: str, languages: Sequence[str]) -> None:
        """Compress a page.

        Args:
            page: its HTML, in English.
            languages: codes of the languages with a catalogue.
        """
        self._english = _content(page)
        self._translated = {code: _content(_translated(page, code)) for code in languages}

    def response(self, scope: Scope) -> Response:
        """Return the response to a request: in the language of its query parameter `lang`.

        In English where there is none, or the page is not translated to it; the page says so.
        """
        language = Request(scope).query_params.get("lang", "")
        return self._translated.get(language, self._english).response(scope)


def languages_of(folder: Path) -> list[str]:
    """Return the codes of the languages to which the page is translated: of its catalogues."""
    return sorted(catalogue.stem for catalogue in folder.glob("messages/*.json"))


def _translated(page: str, code: str) -> str:
    """Return the HTML of a page that its scripts translate, and which preloads what they need."""
    entry = _ENTRY.search(page)
    if entry is None:
        raise ValueError("The page has no module as its entry point.")
    static = f"{entry[1]}static"
    links = (
        f'<link rel="modulepreload" href="{static}/js/translation.js">\n'
        f'<link rel="modulepreload" href="{static}/js/server-sentences.js">\n'
        f'<link rel="preload" href="{static}/messages/{code}.json" as="fetch" crossorigin>\n'
    )
    page = page.replace(_HTML, f'<html lang="{code}"', 1)
    return page.replace("<title>", f"{links}<title>", 1)


def _content(page: str) -> CompressedContent:
    policy = {"Content-Security-Policy": content_policy(page)}
    return CompressedContent(page.encode(), "text/html", policy)


def _opening(page: str, view: str, title: str) -> str:
    """Return the HTML of a page that opens a view, whose title it has."""
    opening = page.replace(_HTML, f'{_HTML} data-view="{html.escape(view)}"', 1)
    return opening.replace(_TITLE, f"<title>{html.escape(title)} · Racing Hexapods</title>", 1)


def _page(name: str, page_files: PageFiles) -> str:
    """Return the HTML of a page of the dashboard's folder, with preloads."""
    folder, features = page_files.folder, page_features(page_files)
    page = with_preloads(
        _with_common_head(name, folder), folder, _start_modules(name, features, page_files)
    )
    # As "<" it could end the script that it stands in.
    declared = json.dumps(features, ensure_ascii=False).replace("<", "\\u003c")
    return page.replace(_FEATURES, _FEATURES.replace("[]", declared))


def view_titles(features: Sequence[Mapping[str, Any]]) -> Mapping[str, str]:
    """Return the titles of the page's views but the first, by their names, which are paths.

    Args:
        features: declarations of the features' parts of the page, as `page_features` has them.
    """
    views = [feature.get("views", {}) for feature in features]
    return {**VIEWS, **{name: view["title"] for named in views for name, view in named.items()}}


def page_features(page_files: PageFiles) -> list[dict[str, Any]]:
    """Return the declarations of the features' parts of the page, read from `feature.json`."""
    folders = {
        file.parent.name: file.parent
        for file in sorted(page_files.folder.glob("features/*/feature.json"))
        if file.parent.name not in page_files.without
    }
    return [
        {
            "name": name,
            "hasCode": (folder / "feature.js").is_file(),
            **json.loads((folder / "feature.json").read_text("utf-8")),
        }
        for name, folder in {**folders, **page_files.added}.items()
    ]


def _start_modules(name: str, features: list[dict[str, Any]], page_files: PageFiles) -> list[str]:
    """Return the modules that the dashboard loads at once because a feature has code for it."""
    at_once = [f["name"] for f in features if f["hasCode"] and "codeFor" not in f]
    has_code = [feature for feature in at_once if feature not in page_files.added]
    return [f"static/features/{feature}/feature.js" for feature in has_code if name == _INDEX]


def _with_common_head(name: str, folder: Path) -> str:
    """Return a page's HTML, with the common part of the dashboard's head inserted."""
    page = (folder / name).read_text("utf-8")
    if _COMMON_OF_INDEX not in page:
        return page
    common = _COMMON.search((folder / _INDEX).read_text("utf-8"))
    if common is None:
        raise ValueError("The head of the dashboard's page has no common part.")
    # Other pages are a folder below the dashboard, as "/r/CODE" is.
    return page.replace(_COMMON_OF_INDEX, re.sub(r'"(?:\./)?static/', '"../static/', common[1]))


def content_policy(page: str) -> str:
    """Build a page's content security policy: its own files, its inline scripts by hash."""
    digests = (hashlib.sha256(body.encode()).digest() for body in _INLINE_SCRIPT.findall(page))
    inline = "".join(f" 'sha256-{base64.b64encode(digest).decode()}'" for digest in digests)
    return (
        f"default-src 'self'; script-src 'self'{inline}; style-src 'self' 'unsafe-inline'; "
        "img-src 'self' data: blob:; connect-src 'self'; frame-src 'self'; object-src 'none'; "
        "base-uri 'none'; form-action 'self'; frame-ancestors 'self'"
    )


def with_preloads(page: str, folder: Path, also: Sequence[str] = ()) -> str:
    """Add a preload for each module, so that none waits until another imports it.

    Args:
        page: the page's HTML, with an import map and one module as entry point; the module's path
            may begin with `../`, as of a page that is not beside `static`.
        folder: folder of the dashboard, which the page knows as `static`.
        also: paths of modules that the entry point loads at once without an import, as
            `imported_modules` has them.
    """
    entry = _ENTRY.search(page)
    packages = _IMPORT_MAP.search(page)
    if entry is None or packages is None:
        raise ValueError("The page has no import map, or no module as its entry point.")
    modules = [posixpath.normpath(path) for path in json.loads(packages[1])["imports"].values()]
    needed = [path for start in (entry[2], *also) for path in imported_modules(start, folder)]
    modules += [entry[1] + path for path in dict.fromkeys(needed)]
    links = "".join(f'<link rel="modulepreload" href="{path}">\n' for path in modules)
    return page[: entry.start()] + links + page[entry.start() :]


def imported_modules(entry: str, folder: Path) -> list[str]:
    """Return a module and all that it imports by relative paths, the nearest first.

    Args:
        entry: the module's path, which begins with `static/`.
        folder: the folder that `static` stands for.
    """
    modules = [entry]
    for module in modules:
        source = (folder / module.removeprefix("static/")).read_text("utf-8")
        for path in _IMPORT.findall(source):
            imported = posixpath.normpath(posixpath.join(posixpath.dirname(module), path))
            if imported not in modules:
                modules.append(imported)
    return modules


@policy(access=WATCH)
def robots_txt(request: Request) -> Response:
    """Return `robots.txt`: it forbids crawlers all paths, unless a feature has another text."""
    services: Services = request.app.state.services
    texts = (feature.robots_txt() for feature in services.features)
    text = next(
        (text_of_feature for text_of_feature in texts if text_of_feature is not None),
        "User-agent: *\nDisallow: /\n",
    )
    age_s = int(timedelta(days=1).total_seconds())
    return PlainTextResponse(text, headers={"Cache-Control": f"max-age={age_s}"})


def page_of(
    page: PageContent, find: Callable[[Services, Mapping[str, str]], object]
) -> Callable[[Request], Response]:
    """Return the endpoint of a page, with the status 404 if the subject of the page is not found.

    Args:
        page: the page, the same for all subjects.
        find: finds the subject by the parameters of the path, or raises `NotFound`.
    """

    def show(request: Request) -> Response:
        response = page.response(request.scope)
        try:
            find(request.app.state.services, request.path_params)
        except NotFound as error:
            if not prefers_html(request.headers):
                return problem(404, as_sentence(str(error)))
            # The page itself requests the subject again, and shows the error.
            response.status_code = 404
        return response

    return show


class _Files(StaticFiles):
    """Static files, each held in memory and compressed once per version."""

    def __init__(self, directory: Path, left_out: Sequence[Path] = ()) -> None:
        """Serve a folder.

        Args:
            directory: the folder.
            left_out: folders in it whose files are not served.
        """
        super().__init__(directory=directory)
        self._left_out = [os.path.realpath(folder) for folder in left_out]
        # By device and inode: some file systems know a file under names in any case.
        self._contents: dict[tuple[int, int], tuple[tuple[int, int], CompressedContent]] = {}

    def lookup_path(self, path: str) -> tuple[str, os.stat_result | None]:
        full_path, stat_result = super().lookup_path(path)
        # By the file that was found: an address may spell its path in many ways.
        is_left_out = any(
            os.path.commonpath([folder, os.path.realpath(full_path)]) == folder
            for folder in self._left_out
            if full_path
        )
        return ("", None) if is_left_out else (full_path, stat_result)

    def file_response(
        self,
        full_path: PathLike,
        stat_result: os.stat_result,
        scope: Scope,
        status_code: int = 200,
    ) -> Response:
        del status_code
        path, version = str(full_path), (stat_result.st_mtime_ns, stat_result.st_size)
        file = (stat_result.st_dev, stat_result.st_ino)
        cached = self._contents.get(file)
        if cached is None or cached[0] != version:
            media_type = mimetypes.guess_type(path)[0] or "text/plain"
            policy = _POLICY_OF_PARTS if media_type in _PARTS else {}
            content = as_sent(Path(path), Path(path).read_bytes())
            cached = (version, CompressedContent(content, media_type, policy))
            self._contents[file] = cached
        return cached[1].response(scope)
