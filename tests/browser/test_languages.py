"""A language of the link is spoken by all of Watch and of a room's phone.

The catalogue is replaced by one whose texts are the English ones in full-width letters: any letter
of ASCII that is left on the page was not looked up.
"""

import json
import re
import string
from collections.abc import Mapping
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, Route, expect

from app.api.pages import languages_of
from hexapods import assets
from tests.browser.rooms import TOKEN, phone
from tests.browser.serving import Serving, finished, hold, serving
from tests.browser.test_workspace import RACE
from tests.conftest import new_page

pytestmark = pytest.mark.timeout(300)

NAMES = (
    *("Racing Hexapods", "English", "Deutsch", "Français"),
    *("Q-learning", "Greedy", "Two-step"),
)
"""What has one name in every language; agents are called as in the field's papers."""
LIST = {"und"}
"""German of the browser's own, in lists."""
TYPED = ("Xyzzy", "Plugh", "Frotz")
"""Texts of the lesson: what people typed stays."""
LESSON = {
    "title": "Xyzzy",
    "cards": [
        {
            "title": "Plugh",
            "text": "Xyzzy.",
            "state": {"form": {"gait": "left-right-origin", "simulator": "kinematic"}},
            "ask": {"kind": "number", "text": "Frotz?", "minimum": -1, "maximum": 2, "unit": "m"},
            "go": "training",
            "reveal": "Plugh.",
        }
    ],
}
UNITS = {"m", "cm", "mm", "s", "ms", "kB", "MB", "h"}
_TEXTS = """() => {
    const isShown = element => element?.checkVisibility({visibilityProperty: true});
    const texts = [];
    for (const element of document.body.querySelectorAll("*")) {
        if (element.closest("script, style, iframe, kbd, .code") || !isShown(element)) continue;
        for (const node of element.childNodes)
            if (node.nodeType === 3) texts.push(node.textContent);
        for (const name of ["aria-label", "title", "alt", "placeholder"])
            if (element.hasAttribute(name)) texts.push(element.getAttribute(name));
    }
    return texts;
}"""


_CUT_TABS = """row => {
    const {left, right} = row.getBoundingClientRect();
    return [...row.children].filter(tab => {
        const box = tab.getBoundingClientRect();
        return box.left < left - 0.5 || box.right > right + 0.5;
    }).map(tab => tab.textContent);
}"""

_FULL_WIDTH = {ord(letter): ord(letter) + 0xFEE0 for letter in string.ascii_letters}


def full_width(text: str) -> str:
    """Return a text in full-width letters, but for the names of its values in braces."""
    parts = re.split(r"(\{\w+(?=[|}]))", text)
    return "".join(part if part.startswith("{") else part.translate(_FULL_WIDTH) for part in parts)


def in_full_width(page: Page) -> None:
    """Let a page have the catalogue of German in full-width letters of English."""
    file = assets.static_dir() / "messages" / "de.json"
    catalogue: Mapping[str, Mapping[str, str]] = json.loads(file.read_text("utf-8"))
    texts = {part: {key: full_width(key) for key in keys} for part, keys in catalogue.items()}

    def answer(route: Route) -> None:
        route.fulfill(json=texts)

    page.route(re.compile(r"/messages/de\.json"), answer)


def untranslated(page: Page, names: tuple[str, ...] = ()) -> list[str]:
    """Return the texts on a page with words that were not looked up."""
    texts: list[str] = page.evaluate(_TEXTS)
    return [text for text in dict.fromkeys(texts) if _words(text, (*names, *NAMES)) - UNITS - LIST]


def _words(text: str, names: tuple[str, ...]) -> set[str]:
    for name in names:
        text = text.replace(name, "")
    return set(re.findall("[A-Za-z]+", text))


def test_all_of_watch_is_in_the_language_of_the_link(
    flat_browser: Browser, server: Serving
) -> None:
    with new_page(flat_browser) as page, server.api() as api:
        in_full_width(page)
        page.goto(f"{server.address}?lang=de")
        expect(page.locator(".plan .robot")).to_have_count(3)
        texts = {"start": untranslated(page)}
        race = finished(api, "races", RACE)
        for moment, time_s in (("Explain this step", 5.0), ("wins", 60.0)):
            hold(api, race, time_s)
            # Before it the stage had the practice that the race needed.
            shown_run = page.get_by_role("group", name=full_width("Shown run"), exact=True)
            expect(shown_run).to_contain_text(full_width("Race: "))
            expect(page.get_by_text(full_width(moment)).first).to_be_visible()
            texts[moment] = untranslated(page)
        hold(api, race, 5.0)
        page.get_by_role("button", name=full_width("Explain this step")).first.click()
        expect(page.get_by_text(full_width("The step brought")).first).to_be_visible()
        texts["why"] = untranslated(page)
        page.keyboard.press("?")
        # What features have in the help comes later.
        help_links = page.get_by_role("dialog").get_by_role("link")
        expect(help_links.filter(has_text=full_width("The paper"))).to_be_visible()
        expect(page.get_by_role("button", name=full_width("Copy the citation"))).to_be_visible()
        texts["help"] = untranslated(page)
        assert {moment: words for moment, words in texts.items() if words} == {}


def test_all_of_a_phone_is_in_the_language_of_the_link(
    flat_browser: Browser, tmp_path: Path
) -> None:
    with (
        serving(tmp_path, token=TOKEN) as school,
        school.api(TOKEN) as api,
        phone(flat_browser) as pupil,
    ):
        page = pupil.page
        in_full_width(page)
        room = api.post("rooms", json={"lesson": LESSON}).raise_for_status().json()
        pupil.enter(school, room["code"], "?lang=de")
        join = page.get_by_role("button", name=full_width("Join"), exact=True)
        expect(join).to_be_visible()
        texts = {"door": untranslated(page, TYPED)}
        join.click()
        prediction = page.get_by_label(full_width("Your prediction"))
        expect(prediction).to_be_visible()
        names = (*TYPED, page.locator("header b").first.inner_text())
        texts["card"] = untranslated(page, names)
        prediction.fill("0,3")
        page.get_by_role("button", name=full_width("Lock my prediction"), exact=True).click()
        expect(prediction).to_have_count(0)
        texts["locked"] = untranslated(page, names)
        assert {moment: words for moment, words in texts.items() if words} == {}


def test_all_tabs_of_study_are_in_view_in_each_language(
    flat_browser: Browser, server: Serving
) -> None:
    cut = dict[str, list[str]]()
    with new_page(flat_browser) as page:
        for code in languages_of(assets.static_dir()):
            page.goto(f"{server.address}?depth=study&lang={code}")
            tabs = page.get_by_role("tab")
            expect(tabs).to_have_count(7)
            for width in (1280, 1440, 1920):
                page.set_viewport_size({"width": width, "height": 900})
                cut[f"{code} at {width}"] = page.get_by_role("tablist").evaluate(_CUT_TABS)
    assert {where: titles for where, titles in cut.items() if titles} == {}
