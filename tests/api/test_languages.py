"""The page in another language: its HTML, and the names that the server gives."""

import json
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from app.api.deps import PageFiles
from app.api.pages import languages_of, page_features
from hexapods import assets
from tests.api.calls import Api

LANGUAGES = languages_of(assets.static_dir())
NAMED = ("gaits", "robots", "worlds", "disturbances", "simulators", "observations", "clocks")
"""Lists of the options that Watch and a room's phone show."""
PROPER = {"Freenove big hexapod", "PhantomX Mk4", "Chica"}
"""Names of products."""


@cache
def catalogue(code: str) -> Mapping[str, Mapping[str, str]]:
    """Return a catalogue of the page: texts of its scripts and of the server, by the English."""
    file = assets.static_dir() / "messages" / f"{code}.json"
    texts: Mapping[str, Mapping[str, str]] = json.loads(file.read_text("utf-8"))
    return texts


def texts_in(answer: Any) -> Iterator[str]:
    """Yield the texts in a JSON document."""
    if isinstance(answer, str):
        yield answer
    elif isinstance(answer, Mapping):
        for value in answer.values():
            yield from texts_in(value)
    elif isinstance(answer, list):
        for value in answer:
            yield from texts_in(value)


def test_there_are_german_and_french() -> None:
    assert LANGUAGES == ["de", "fr"]


@pytest.mark.parametrize("path", ["/", "/runs"])
@pytest.mark.parametrize("code", LANGUAGES)
def test_the_html_says_the_language_and_preloads_its_catalogue(
    api: Api, path: str, code: str
) -> None:
    page = api.client.get(f"{path}?lang={code}").text
    english = api.client.get(path).text

    assert f'<html lang="{code}"' in page
    assert f'<link rel="preload" href="static/messages/{code}.json"' in page
    assert api.client.get(f"/static/messages/{code}.json").json() == catalogue(code)
    assert '<html lang="en"' in english
    assert "messages" not in english


@pytest.mark.parametrize("lang", ["en", "xx", "", "de-AT", "../de", "de&lang=fr"])
def test_a_language_without_a_catalogue_is_english(api: Api, lang: str) -> None:
    page = api.client.get(f"/?lang={lang}").text

    assert (page == api.client.get("/").text) == ("fr" not in lang)


@pytest.mark.parametrize("code", LANGUAGES)
def test_the_names_that_watch_shows_are_translated(api: Api, code: str) -> None:
    options = api.client.get("/api/v1/options").json()
    titles = {entry["title"] for name in NAMED for entry in options[name]} - PROPER

    assert titles - catalogue(code)["server"].keys() == set()


@pytest.mark.parametrize("code", LANGUAGES)
def test_a_catalogue_translates_no_text_that_the_server_does_not_have(api: Api, code: str) -> None:
    files = PageFiles(Path(assets.static_dir()))
    texts = {*texts_in(api.client.get("/api/v1/options").json()), *texts_in(page_features(files))}
    named = {key for key in catalogue(code)["server"] if "{" not in key}

    assert named - texts == set()


@pytest.mark.parametrize(("language", "query"), [("de", "?lang=de"), ("xx", ""), (None, "")])
def test_a_room_has_the_language_of_the_page_that_shows_it(
    api: Api, language: str | None, query: str
) -> None:
    headers = {} if language is None else {"Page-Language": language}
    opened = api.call("POST", "/rooms", headers=headers).json()
    room = api.call("GET", f"/rooms/{opened['code']}", headers=headers).json()

    for answer in (opened, room):
        assert answer["address"].endswith(f"/r/{room['address'].rsplit('/', 1)[1]}")
        assert answer["address"].partition("?")[2] == query.removeprefix("?")
    api.call("POST", f"/rooms/{opened['code']}/end")
