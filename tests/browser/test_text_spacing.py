"""Text spaced as WCAG 2.2, 1.4.12, lets readers space it: nothing that is read is cut off."""

import re
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, ViewportSize, expect

from tests.browser.dashboard import Dashboard
from tests.browser.rooms import PHONE, TOKEN, phone
from tests.browser.serving import Serving, finished, hold, serving
from tests.browser.test_room import LESSON
from tests.browser.test_workspace import RACE

pytestmark = pytest.mark.timeout(200)

LAPTOP: ViewportSize = {"width": 1280, "height": 720}
# Lines, letters, words and paragraphs; the policy of pages allows no element `style`.
_SPACE = """() => {
    const sheet = new CSSStyleSheet();
    sheet.replaceSync(`* {
        line-height: 1.5 !important; letter-spacing: 0.12em !important;
        word-spacing: 0.16em !important;
    }
    p { margin-bottom: 2em !important; }`);
    document.adoptedStyleSheets = [sheet];
}"""
# A text is cut off where its lines lie outside a box that hides what overflows, or outside of one
# that scrolls only downwards; or beyond the window's sides. What is shortened with an ellipsis
# elsewhere, too, is left out: `.chips` and the head, whose whole text is its tooltip.
_CUT_OFF = """scope => {
    const problems = [];
    const isHidden = overflow => overflow === "hidden" || overflow === "clip";
    const left_out = "svg, .sr-only, .skip, iframe, option, .chips, .says, .scroller";
    for (const one of document.querySelector(scope).querySelectorAll("*")) {
        if (one.closest(left_out) || !one.checkVisibility({visibilityProperty: true})) continue;
        const texts = [...one.childNodes].filter(n => n.nodeType === 3 && n.textContent.trim());
        const lines = texts.flatMap(text => {
            const range = document.createRange();
            range.selectNodeContents(text);
            return [...range.getClientRects()];
        });
        for (const line of lines) {
            const where = `${one.outerHTML.replace(/\\s+/g, " ").slice(0, 90)}: `;
            if (line.left < -1 || line.right > innerWidth + 1) problems.push(`${where} window`);
            for (let around = one; around !== document.body; around = around.parentElement) {
                const {overflowX, overflowY} = getComputedStyle(around);
                const box = around.getBoundingClientRect();
                const isScroller = overflowX === "auto" || overflowY === "auto";
                if ((isHidden(overflowX) || isScroller)
                    && (line.left < box.left - 1 || line.right > box.right + 1))
                    problems.push(`${where} across, by ${around.className}`);
                // The lower parts of letters are within half of the space between lines.
                if (isHidden(overflowY)
                    && (line.top < box.top - 4 || line.bottom > box.bottom + 4))
                    problems.push(`${where} downwards, by ${around.className}`);
                if (isScroller) break;
            }
        }
    }
    return problems;
}"""


def cut_off(page: Page, scope: str = "body") -> list[str]:
    """Space the text of a page, and return what is cut off in it."""
    page.evaluate(_SPACE)
    problems: list[str] = page.evaluate(_CUT_OFF, scope)
    return problems


def test_board_tabs_and_time_are_whole(dashboard: Dashboard, server: Serving) -> None:
    page = dashboard.page
    with server.api() as api:
        # At its end, when all columns of the board have their figures.
        hold(api, finished(api, "races", RACE), 60.0)
    problems: dict[str, list[str]] = {}
    for size in (LAPTOP, PHONE):
        page.set_viewport_size(size)
        for depth in ("watch", "try", "study"):
            for tab in ("board", "train") if depth != "watch" else ("board",):
                page.goto(server.link(depth=depth, tab=tab))
                expect(dashboard.headline).to_have_text(re.compile("wins"))
                expect(page.locator("#panel-body")).not_to_be_empty()
                problems[f"{depth} {tab} {size['width']}"] = cut_off(page)
    assert {where: what for where, what in problems.items() if what} == {}


def test_a_room_on_a_phone_is_whole(flat_browser: Browser, tmp_path: Path) -> None:
    with (
        serving(tmp_path, token=TOKEN) as school,
        school.api(TOKEN) as api,
        phone(flat_browser) as teacher,
        phone(flat_browser) as pupil,
    ):
        code = api.post("rooms", json={"lesson": LESSON}).raise_for_status().json()["code"]
        pupil.enter(school, code)
        expect(pupil.button("Join")).to_be_visible()
        assert cut_off(pupil.page) == []
        pupil.press("Join")
        expect(pupil.page.get_by_label("Your prediction")).to_be_visible()
        assert cut_off(pupil.page) == []
        teacher.page.goto(f"{school.address}?token={TOKEN}")
        teacher.enter(school, code)
        expect(teacher.button("Reveal")).to_be_visible()
        assert cut_off(teacher.page) == []
