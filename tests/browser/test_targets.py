"""Every control is large enough to be met: 24 px (WCAG 2.2, 2.5.8), and 40 px for a thumb."""

from pathlib import Path
from typing import Any

import httpx2
import pytest
from playwright.sync_api import Browser, ViewportSize, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import serving
from tests.browser.test_spectators import TOKEN, finished_race
from tests.conftest import new_page

pytestmark = pytest.mark.timeout(300)

DESK: ViewportSize = {"width": 1440, "height": 900}
PHONE: ViewportSize = {"width": 390, "height": 844}
_UNFOLD = "() => document.querySelectorAll('details:not(.menu)').forEach(one => one.open = true)"
# A box to tick is met by its label too. Of links within a sentence the text gives the height.
_TOO_SMALL = """least => {
    const controls = "a[href], button, input, select, textarea, summary, [role=slider], [role=tab]";
    const isShown = one => one.checkVisibility({visibilityProperty: true});
    const isInSentence = one => getComputedStyle(one).display.startsWith("inline")
        && [...one.parentElement.childNodes].some(n => n.nodeType === 3 && n.textContent.trim());
    return [...document.querySelectorAll(controls)]
        .filter(one => isShown(one) && !isInSentence(one))
        .map(one => [one, [one, ...(one.labels ?? [])].map(each => each.getBoundingClientRect())])
        .map(([one, boxes]) => [one, Math.max(...boxes.map(box => box.width)),
                                Math.max(...boxes.map(box => box.height))])
        .filter(([, width, height]) => Math.min(width, height) < least - 0.5)
        .map(([one, width, height]) =>
            `${one.outerHTML.slice(0, 120)}: ${width.toFixed(1)} x ${height.toFixed(1)}`);
}"""


@pytest.mark.parametrize(("size", "least_px"), [(DESK, 24), (PHONE, 40)], ids=["desk", "phone"])
def test_no_control_is_too_small(
    size: ViewportSize, least_px: int, flat_browser: Browser, tmp_path: Path
) -> None:
    bearer = {"Authorization": f"Bearer {TOKEN}"}
    has_touch = size == PHONE
    with (
        serving(tmp_path, token=TOKEN) as server,
        httpx2.Client(base_url=f"{server.address}api/v1/", headers=bearer) as api,
        new_page(flat_browser, viewport=size, has_touch=has_touch, is_mobile=has_touch) as page,
    ):
        finished_race(api)
        dashboard = Dashboard(page, has_3d=False)
        found: dict[str, Any] = {}
        for role, address in (
            ("spectator", server.address),
            ("operator", f"{server.address}?token={TOKEN}"),
        ):
            dashboard.open(address)
            dashboard.eventually(lambda: dashboard.has_figures(lanes=2), "the board is there")
            for view in ("", "#runs", "#experiments"):
                page.evaluate("view => { location.hash = view; }", view)
                marks = {"": ".stage", "#runs": ".run", "#experiments": ".experiment-list, main"}
                expect(page.locator(marks[view]).first).to_be_visible()
                page.evaluate(_UNFOLD)
                for menu in page.locator("details.menu").all()[:2]:
                    menu.evaluate("one => { one.open = true; }")
                page.wait_for_timeout(300)
                if too_small := page.evaluate(_TOO_SMALL, least_px):
                    found[f"{role}{view}"] = too_small
            assert dashboard.scroll_width() == size["width"]
        assert found == {}
        assert dashboard.complaints == []
