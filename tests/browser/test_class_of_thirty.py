"""Thirty phones and a projector go through all built-in lessons, and the sheets print on one page.

Two phones and the projector are pages of a browser; the others answer and start over REST, as
phones that are closed meanwhile.
"""

import json
import random
import re
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import httpx2
import pytest
from playwright.sync_api import Browser, Page, ViewportSize, expect

from app.features.classroom.lesson_file import read_file
from hexapods.shows.show import MAX_SPEED
from tests.browser.rooms import PUBLIC_URL, TOKEN, RoomPage, phone
from tests.browser.serving import Serving, serving
from tests.conftest import new_page

pytestmark = pytest.mark.timeout(900)

PUPILS = 30
RUNNERS = 3
"""Pupils who start what a card runs: each takes a core for a while."""
PATIENCE_S = 180
SIZES: list[ViewportSize] = [
    {"width": 1280, "height": 720},
    {"width": 1920, "height": 1080},
    {"width": 1024, "height": 768},
]
BUILT_IN = sorted((Path(__file__).parents[2] / "app/features/classroom/built_in").glob("*.yaml"))
_LEAST_PX = 18
"""Of type at 1920 × 1080."""
# What lies outside of the window or of a part that cuts it off, and text whose line is cut off.
_CLIPPED = """() => {
    const seen = [...document.querySelectorAll(".projector *")]
        .filter(one => one.checkVisibility({visibilityProperty: true}) && !one.closest("iframe"));
    const name = one =>
        `${one.tagName}.${one.getAttribute("class")}: ${one.textContent.slice(0, 40)}`;
    const beyond = seen.filter(one => {
        const {left, top, right, bottom, width, height} = one.getBoundingClientRect();
        if (width === 0 || height === 0 || one.closest(".sr-only")) return false;
        return left < -1 || top < -1 || right > innerWidth + 1 || bottom > innerHeight + 1;
    });
    const cut = seen.filter(one => one instanceof HTMLElement && one.tagName !== "IFRAME"
        && getComputedStyle(one).overflow !== "visible"
        && (one.scrollHeight > one.clientHeight + 1 || one.scrollWidth > one.clientWidth + 1));
    const texts = [...document.querySelectorAll(".plot svg text")].filter(one => {
        const box = one.getBoundingClientRect();
        const place = one.closest(".plot").getBoundingClientRect();
        return box.left < place.left - 2 || box.right > place.right + 2
            || box.top < place.top - 2 || box.bottom > place.bottom + 2;
    });
    return [...beyond, ...cut, ...texts].map(name);
}"""
_SMALL = """least => [...document.querySelectorAll(".projector *")]
    .filter(one => one.checkVisibility() && [...one.childNodes].some(n => n.nodeType === 3
        && n.textContent.trim()) && parseFloat(getComputedStyle(one).fontSize) < least)
    .map(one => one.textContent.slice(0, 40))"""
_VOTES_ARE = """all => [...document.querySelectorAll(".voted b")]
    .reduce((sum, one) => sum + Number(one.textContent), 0) === all"""
# Each layout of the projector, in the order of coming.
_WATCH = """() => {
    globalThis.acts = [];
    new MutationObserver(() => {
        const act = document.querySelector(".layout")?.className ?? "";
        if (act !== globalThis.acts.at(-1)) globalThis.acts.push(act);
    }).observe(document, {subtree: true, childList: true, attributes: true});
}"""


@pytest.fixture
def school(tmp_path: Path) -> Iterator[Serving]:
    with serving(tmp_path, token=TOKEN, public_url=PUBLIC_URL) as server:
        yield server


class Pupils:
    """Those who answer and start over REST."""

    def __init__(self, school: Serving, code: str, stack: ExitStack, count: int) -> None:
        self._code, self._draw = code, random.Random(code)
        self._all = [stack.enter_context(school.api()) for _ in range(count)]
        for api in self._all:
            api.post(f"rooms/{code}/participants", json={}).raise_for_status()

    def answer(self, number: int, card: dict[str, Any]) -> None:
        for api in self._all:
            body = {"card": number, "value": self._value(card)}
            api.post(f"rooms/{self._code}/predictions", json=body).raise_for_status()

    def run(self, number: int, card: dict[str, Any]) -> None:
        for api in self._all[:RUNNERS]:
            body = {"card": number, "settings": self._settings(card)}
            api.post(f"rooms/{self._code}/runs", json=body).raise_for_status()

    def _value(self, card: dict[str, Any]) -> Any:
        ask, steps = card["ask"], steps_of(card)
        if ask["kind"] == "choice":
            return self._draw.choice(ask["choices"])
        if ask["kind"] == "number":
            return self._draw.uniform(ask["minimum"], ask["maximum"])
        points = [[n * steps / 8, round(self._draw.uniform(0, 0.6), 2)] for n in range(9)]
        return points if ask["kind"] == "curve" else points[4]

    def _settings(self, card: dict[str, Any]) -> dict[str, Any]:
        given: dict[str, Any] = {}
        for name, bounds in card["may"].items():
            if bounds["choices"]:
                given[name] = self._draw.choice(bounds["choices"])
            else:
                value = self._draw.uniform(bounds["minimum"], min(bounds["maximum"], 400))
                given[name] = round(value) if name == "steps" else value
        return given


def steps_of(card: dict[str, Any]) -> float:
    """Steps of practice of a card."""
    form = (card["state"] or {}).get("form") or {}
    return float(form.get("steps", 500))


def nothing_is_clipped(projector: Page, where: str) -> None:
    """Check the projector at each size, and that no type is small at the largest."""
    for size in SIZES:
        projector.set_viewport_size(size)
        projector.wait_for_timeout(150)
        clipped = projector.evaluate(_CLIPPED)
        assert clipped == [], (where, size, clipped)
        if size["width"] == 1920:
            assert projector.evaluate(_SMALL, _LEAST_PX) == [], where


@pytest.mark.parametrize("path", BUILT_IN, ids=lambda path: path.stem)
def test_thirty_simulated_phones_and_a_projector_go_through_all_built_in_lessons(
    flat_browser: Browser, school: Serving, path: Path
) -> None:
    with (
        ExitStack() as stack,
        school.api(TOKEN) as api,
        new_page(flat_browser, viewport=SIZES[0]) as projector,
        phone(flat_browser) as first,
        phone(flat_browser) as second,
    ):
        code = api.post("rooms", json={"lesson": path.stem}).raise_for_status().json()["code"]
        screen = RoomPage(projector, has_3d=False)
        projector.goto(f"{school.address}?token={TOKEN}")
        screen.enter(school, code, "?projector")
        expect(projector.locator(".layout.lobby")).to_be_visible()
        nothing_is_clipped(projector, "lobby")
        for pupil in (first, second):
            pupil.enter(school, code)
            pupil.press("Join")
        pupils = Pupils(school, code, stack, PUPILS - 2)
        screen.sees(f"{PUPILS} are in")
        lesson = Taught(api, code, projector, first, pupils)
        projector.evaluate(_WATCH)
        for number in range(len(lesson.cards)):
            lesson.go_through(number)
        second.sees(f"Card {len(lesson.cards)} of {len(lesson.cards)}")
        assert screen.complaints == []


class Taught:
    """A lesson in a room, as its teacher, its projector and its pupils go through it."""

    def __init__(
        self, api: httpx2.Client, code: str, projector: Page, first: RoomPage, pupils: Pupils
    ) -> None:
        self._api, self._code, self._projector = api, code, projector
        self._first, self._pupils = first, pupils
        self.cards: list[dict[str, Any]] = self._room()["lesson"]["cards"]

    def _room(self) -> dict[str, Any]:
        room: dict[str, Any] = self._api.get(f"rooms/{self._code}").raise_for_status().json()
        return room

    def go_through(self, number: int) -> None:
        """Let all answer and run a card, reveal it, and look at what the projector shows of it."""
        card, projector = self.cards[number], self._projector
        where, ask, go = f"card {number}: {card['title']}", card["ask"], card["go"]
        self._api.put(f"rooms/{self._code}/card", json={"card": number}).raise_for_status()
        expect(projector.locator(".where")).to_contain_text(f"{number + 1} of {len(self.cards)}")
        nothing_is_clipped(projector, where)
        if ask is not None:
            self._pupils.answer(number, card)
        if go is not None:
            self._pupils.run(number, card)
        if ask is not None or go is not None:
            acts_on(self._first, card, number, len(self.cards))
        if go is not None:
            wait_for_runs(self._api, self._code, number)
            # That of the phone is among them once it has been seen there.
            landing = projector.locator(".landing")
            expect(landing).to_contain_text(f"{RUNNERS + 1} ", timeout=1000 * PATIENCE_S)
            nothing_is_clipped(projector, f"{where}, landed")
        elif ask is not None:
            expect(projector.locator(".locked-count")).to_contain_text(f"{PUPILS - 1} of {PUPILS}")
        assert projector.locator(".act-place").count() == 0, f"{where}: an act before the reveal"
        knowledge = self._room()["knowledge"]
        if knowledge != "before" and (ask is not None or go is not None):
            self._reveal(card, "gain" if knowledge == "after" else None, where)

    def _reveal(self, card: dict[str, Any], act: str | None, where: str) -> None:
        projector, go = self._projector, card["go"]
        act = act or (card["ask"]["kind"] if card["ask"] else "distances")
        projector.evaluate("globalThis.acts = []")
        self._api.post(f"rooms/{self._code}/reveal", json={}).raise_for_status()
        # The race is shown as fast as it can be.
        stage = f"{projector.url.partition('?')[0]}/api/v1/stage"
        self._api.put(stage, json={"speed": MAX_SPEED}).raise_for_status()
        expect(projector.locator(f".layout.act-{act}")).to_be_visible()
        has_its_picture(projector, act, where)
        nothing_is_clipped(projector, f"{where}, revealed")
        names = [
            part for layout in projector.evaluate("globalThis.acts") for part in layout.split()
        ]
        acts = [name for name in names if name.startswith("act-")]
        # The robots have raced before anything that they came to is shown.
        expected = ["act-run", f"act-{act}"] if go in ("training", "race") else [f"act-{act}"]
        assert list(dict.fromkeys(acts)) == expected, (where, acts)


def acts_on(pupil: RoomPage, card: dict[str, Any], number: int, cards: int) -> None:
    """Answer and run a card on a phone, by what it shows."""
    ask = card["ask"]
    pupil.sees(f"Card {number + 1} of {cards}")
    if ask is not None:
        question = pupil.page.get_by_role("region", name="Question")
        if ask["kind"] == "choice":
            question.get_by_role("button").first.tap()
        elif ask["kind"] == "number":
            question.get_by_label("Your prediction").fill(str(max(ask["minimum"], 0.25)))
        else:
            chart = question.get_by_role("slider", name=re.compile("^Your curve"))
            chart.focus()
            pupil.page.keyboard.press("PageUp")
    if ask is not None and card["go"]:
        pupil.press("Lock my prediction, and go")
    else:
        pupil.press(re.compile("^(Lock my prediction|Go: )"))


def has_its_picture(projector: Page, act: str, where: str) -> None:
    """Check that an act has its picture, and that this fills its place."""
    place = projector.locator(".act-place")
    picture = place.locator(".votes, .plot svg").first
    expect(picture).to_be_visible()
    if act in ("choice", "gain") and place.locator(".votes").count():
        projector.wait_for_function(_VOTES_ARE, arg=PUPILS - 1)
    if act == "gain":
        expect(place.locator(".gain-bars")).to_contain_text(f"of {PUPILS - 1} right")
    box, around = picture.bounding_box(), place.bounding_box()
    assert box is not None
    assert around is not None
    assert box["width"] > 0.9 * around["width"] - 60, (where, box, around)


def wait_for_runs(api: httpx2.Client, code: str, number: int) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while True:
        (view,) = api.get(f"rooms/{code}/results?card={number}").json()["cards"]
        if view["finished"] == RUNNERS + 1:
            return
        assert time.monotonic() < deadline, json.dumps(view)[:400]
        time.sleep(0.2)


def test_a_second_projector_shows_the_same_also_when_the_lesson_is_edited_meanwhile(
    flat_browser: Browser, school: Serving
) -> None:
    lesson: dict[str, Any] = {
        "title": "Edited while it is taught",
        "cards": [
            {
                "title": "How many?",
                "text": "Legs.",
                "ask": {"kind": "number", "text": "Legs?", "minimum": 0, "maximum": 9},
                "reveal": {"text": "An insect.", "answer": 6},
            },
            {"title": "The end", "text": "Good bye."},
        ],
    }
    with ExitStack() as stack:
        api = stack.enter_context(school.api(TOKEN))
        lesson_id = api.post("lessons", json=lesson).raise_for_status().json()["id"]
        code = api.post("rooms", json={"lesson": lesson_id}).raise_for_status().json()["code"]
        screens = []
        for size in SIZES[:2]:
            page = stack.enter_context(new_page(flat_browser, viewport=size))
            page.goto(f"{school.address}?token={TOKEN}")
            RoomPage(page, has_3d=False).enter(school, code, "?projector")
            screens.append(page)
        pupils = Pupils(school, code, stack, 3)
        card = api.get(f"rooms/{code}").json()["lesson"]["cards"][0]
        pupils.answer(0, card)
        # The room has a copy: what is edited is another lesson, and the first may be deleted.
        edited = {**lesson, "cards": [{"title": "Another", "text": "x"}]}
        api.post("lessons", json=edited).raise_for_status()
        api.delete(f"lessons/{lesson_id}").raise_for_status()
        api.post(f"rooms/{code}/reveal", json={}).raise_for_status()
        for page in screens:
            expect(page.get_by_role("img", name="3 predictions: 3; right: 6")).to_be_visible()
            expect(page.locator(".reveal-text")).to_contain_text("An insect.")
        api.put(f"rooms/{code}/card", json={"card": 1}).raise_for_status()
        for page in screens:
            expect(page.locator("#shown-title")).to_have_text("The end")
        screens[0].reload()
        expect(screens[0].locator("#shown-title")).to_have_text("The end")


def test_the_sheet_of_each_built_in_lesson_is_one_page_for_its_teacher_alone(
    flat_browser: Browser, school: Serving
) -> None:
    with new_page(flat_browser) as page:
        stranger = page.request.get(f"{school.address}l/{BUILT_IN[0].stem}/sheet")
        assert stranger.status in (401, 403)
        page.goto(f"{school.address}?token={TOKEN}")
        for path in BUILT_IN:
            lesson = read_file(path.read_bytes(), path.name)
            page.goto(f"{school.address}l/{path.stem}/sheet")
            for number, card in enumerate(lesson.cards, 1):
                heading = page.get_by_role("heading", name=f"{number}. {card.title}", exact=True)
                expect(heading).to_be_visible()
            pdf = page.pdf(prefer_css_page_size=True)
            assert pdf.count(b"/Type /Page\n") == 1, path.stem
