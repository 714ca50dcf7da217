"""Forced colours: what is said by a colour alone elsewhere is seen in the reader's own colours."""

import io
import re
from collections import Counter

import pytest
from PIL import Image
from playwright.sync_api import Browser, Locator, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving, finished, hold
from tests.browser.test_workspace import RACE

pytestmark = pytest.mark.timeout(200)

LEAST_CONTRAST = 3
"""Of graphics, to the ground beside them (WCAG 2.2, 1.4.11)."""
PARTS_OF_BOARD = (
    *(".rail input", ".marks > *", ".lane-row", ".switch input", ".live .dot", ".time-bar .play"),
    *(".distance-bar i", ".distance-bar b", ".time-line .walked", ".board .swatch", ".bars"),
)
"""Each says something by its ground or by a gradient, which forced colours take from it."""
CHOICES = {
    "tab": ("[role=tab][aria-selected=true]", "[role=tab][aria-selected=false]"),
    "depth": (".depth [aria-pressed=true]", ".depth [aria-pressed=false]"),
    "view": (".nav a[aria-current]", ".nav a:not([aria-current])"),
}
"""What is chosen, and what is not."""
Color = tuple[int, ...]


def luminance(color: Color) -> float:
    """Return the relative luminance, as WCAG defines it."""
    parts = [c / 255 / 12.92 if c <= 10 else ((c / 255 + 0.055) / 1.055) ** 2.4 for c in color]
    return 0.2126 * parts[0] + 0.7152 * parts[1] + 0.0722 * parts[2]


def contrast(first: Color, second: Color) -> float:
    """Return the contrast of two colours, from 1 to 21."""
    low, high = sorted((luminance(first), luminance(second)))
    return (high + 0.05) / (low + 0.05)


def colors_of(element: Locator) -> Counter[Color]:
    """Return how many pixels of an element have which colour."""
    picture = Image.open(io.BytesIO(element.screenshot())).convert("RGB")
    colors = picture.getcolors(picture.width * picture.height)
    assert colors is not None
    return Counter({color: count for count, color in colors if isinstance(color, tuple)})


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_what_colors_say_is_seen(flat_browser: Browser, server: Serving, scheme: str) -> None:
    with server.api() as api:
        hold(api, finished(api, "races", RACE), 5.0)
    # As a system with a contrast theme has it: all its pixels, and colours by its own choice.
    with flat_browser.new_context(forced_colors="active", color_scheme=scheme) as context:  # type: ignore[arg-type]
        dashboard = Dashboard(context.new_page(), has_3d=False)
        page = dashboard.page
        page.emulate_media(reduced_motion="reduce")
        dashboard.open(server.link(depth="study"))
        expect(dashboard.headline).to_have_text(re.compile("leads|level"))
        canvas: Color = (255, 255, 255) if scheme == "light" else (0, 0, 0)
        assert colors_of(page.locator("body")).most_common(1)[0][0] == canvas

        for part in PARTS_OF_BOARD:
            element = page.locator(part).first
            seen = max(contrast(color, canvas) for color in colors_of(element))
            assert seen >= LEAST_CONTRAST, part
        for choice, selectors in CHOICES.items():
            [chosen, other] = [
                colors_of(page.locator(selector).first).most_common(1)[0][0]
                for selector in selectors
            ]
            assert other == canvas, choice
            assert contrast(chosen, other) >= LEAST_CONTRAST, choice
        lanes = {
            colors_of(page.locator(".distance-bar i").nth(lane)).most_common(1)[0][0]
            for lane in range(3)
        }
        assert len(lanes) == 3, "lanes keep their colours"

        # The scale of values: its colours, on each cell with the value in words.
        dashboard.open_tab("Why")
        cells = page.locator(".values td:not(.untried, .here)")
        expect(cells.first).to_be_visible()
        assert {colors_of(cell).most_common(1)[0][0] for cell in cells.all()[:3]} != {canvas}
        assert dashboard.complaints == []
