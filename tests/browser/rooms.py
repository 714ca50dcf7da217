"""Pages of a room as tests see them: of a participant, of the teacher, and the projector."""

import re
from collections.abc import Iterator
from contextlib import contextmanager

from playwright.sync_api import Browser, Locator, ViewportSize, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving
from tests.browser.type_sizes import small_texts
from tests.conftest import new_page

TOKEN = "for-the-teacher-of-the-class"
PUBLIC_URL = "http://class.example"
"""Where phones reach a server, which thus shows them QR codes."""
PHONE: ViewportSize = {"width": 390, "height": 844}
SCREEN: ViewportSize = {"width": 1920, "height": 1080}
LEAST_PX = 28
"""Of type on the projector, which is read from ten metres."""
THUMB_PX = 40
_OVERFLOW = """() => {
    const {scrollWidth, scrollHeight} = document.scrollingElement;
    return [Math.max(0, scrollWidth - innerWidth), Math.max(0, scrollHeight - innerHeight)];
}"""
_CUT_OFF = """cards => cards.map(one => one.scrollHeight - one.clientHeight)
    .filter(px => px > 0)"""
_KEPT = re.compile(r"^(\w+ \w+)\s*seed (\d+)$")


class RoomPage(Dashboard):
    """A page of a room, by the words that a person reads on it."""

    def enter(self, server: Serving, code: str, query: str = "") -> None:
        """Open the room; it is a page of its own."""
        self.page.goto(f"{server.address}r/{code}{query}")

    def press(self, name: str | re.Pattern[str]) -> None:
        """Tap a button, as a thumb does."""
        button = self.page.get_by_role("button", name=name, exact=isinstance(name, str))
        expect(button).not_to_have_attribute("aria-disabled", "true")
        button.tap()

    def sees(self, words: str | re.Pattern[str]) -> None:
        """Wait until the page has these words."""
        expect(self.page.locator("body")).to_contain_text(words)

    @property
    def who(self) -> tuple[str, int]:
        """Name and seed of the participant."""
        head = self.page.get_by_role("banner").get_by_role("paragraph").first
        expect(head).to_have_text(_KEPT)
        match = _KEPT.match(head.inner_text().strip().replace("\n", " "))
        assert match is not None
        return match[1], int(match[2])

    @property
    def distance(self) -> Locator:
        """Distance of the participant's own robot."""
        return self.page.locator(".own-distance b")


@contextmanager
def phone(browser: Browser) -> Iterator[RoomPage]:
    """A phone of somebody else, with cookies of its own, that must not complain."""
    with new_page(browser, viewport=PHONE, has_touch=True, is_mobile=True) as page:
        watched = RoomPage(page, has_3d=False)
        yield watched
        assert watched.complaints == [], watched.complaints


def is_accessible(page: RoomPage, *, is_touched: bool = True) -> None:
    """Check axe's rules in both themes, the width, and the size of what is tapped."""
    violations = page.violations_in_both_themes()
    assert violations == [], violations
    page.page.emulate_media(color_scheme="light")
    if is_touched:
        assert page.scroll_width() == PHONE["width"]
        small = page.small_targets(THUMB_PX)
        assert small == [], small


def is_read_from_afar(projector: RoomPage) -> None:
    """Check that no type is small, and that nothing is cut off or beyond the screen's edges."""
    small = small_texts(projector.page, LEAST_PX)
    assert small == [], small
    beyond = projector.page.evaluate(_OVERFLOW)
    assert beyond == [0, 0], beyond
    cut_off = projector.page.locator(".shown-card").evaluate_all(_CUT_OFF)
    assert cut_off == [], cut_off
