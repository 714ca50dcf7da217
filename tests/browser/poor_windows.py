"""Windows that leave a page little: narrow, turned, with enlarged type, or with colours forced."""

from collections.abc import Iterator
from typing import NamedTuple

from playwright.sync_api import Page, ViewportSize

DEFAULT_TYPE_PX = 16


class PoorWindow(NamedTuple):
    """A window as a reader may have it."""

    name: str
    size: ViewportSize
    type_px: int = DEFAULT_TYPE_PX
    """Size of type that the reader has set as the browser's default [px]."""
    has_forced_colors: bool = False


UPRIGHT: ViewportSize = {"width": 390, "height": 844}
POOR_WINDOWS = [
    PoorWindow("narrow", {"width": 320, "height": 640}),
    PoorWindow("upright", UPRIGHT),
    # The same phone, turned while the page is open.
    PoorWindow("turned", {"width": 844, "height": 390}),
    PoorWindow("large type on a laptop", {"width": 1280, "height": 720}, 2 * DEFAULT_TYPE_PX),
    PoorWindow("large type on a phone", UPRIGHT, 2 * DEFAULT_TYPE_PX),
    PoorWindow("forced colors", {"width": 1280, "height": 720}, has_forced_colors=True),
]
"""Each follows on the one before, in a page that is open."""

_CONTROLS = "a[href], button, input, select, textarea, summary, [role=slider], [role=tab]"
# Each control is brought into view as a reader can: by scrolling what scrolls for a reader.
_OUT_OF_REACH = """([scope, controls]) => {
    const problems = [];
    const viewport = document.scrollingElement;
    const describe = one => one.outerHTML.replace(/\\s+/g, " ").slice(0, 110);
    if (viewport.scrollWidth > innerWidth)
        problems.push(`the page is ${viewport.scrollWidth} px wide`);
    const dialog = [...document.querySelectorAll("dialog:modal")].at(-1);
    const isHeld = ({overflowX, overflowY}) => [overflowX, overflowY].includes("hidden");
    for (const control of (dialog ?? document.querySelector(scope)).querySelectorAll(controls)) {
        const isSeen = control.checkVisibility({visibilityProperty: true});
        if (!isSeen || control.closest(".skip, .sr-only")) continue;
        control.scrollIntoView({block: "center", inline: "nearest", behavior: "instant"});
        for (let around = control.parentElement; around; around = around.parentElement) {
            const {scrollLeft, scrollTop} = around === document.body ? viewport : around;
            if (isHeld(getComputedStyle(around)) && scrollLeft + scrollTop > 0) {
                const cutter = around.className || around.tagName;
                problems.push(`${describe(control)} is cut off by ${cutter}`);
                around.scrollTo(0, 0);
                viewport.scrollTo(0, 0);
            }
        }
        const [{left, top, width, height}] = control.getClientRects();
        const met = document.elementFromPoint(left + width / 2, top + height / 2);
        const isMet = control.contains(met) || met?.closest("label")?.control === control;
        const cover = met ? describe(met) : "the window's edge";
        if (!isMet) problems.push(`${describe(control)} is covered by ${cover}`);
    }
    return problems;
}"""
# What colours are forced upon keeps no shadow and no gradient: only an outline shows the focus.
_WITHOUT_FOCUS = """([scope, controls]) => {
    const dialog = [...document.querySelectorAll("dialog:modal")].at(-1);
    const focused = document.activeElement;
    focused?.blur();
    const without = [...(dialog ?? document.querySelector(scope)).querySelectorAll(controls)]
        .filter(control => control.checkVisibility({visibilityProperty: true}) && !control.disabled)
        .filter(control => {
            control.focus({focusVisible: true, preventScroll: true});
            const styles = ["", "::after"].map(part => getComputedStyle(control, part));
            const isOutlined = styles.some(({outlineStyle, outlineWidth}) =>
                outlineStyle !== "none" && parseFloat(outlineWidth) >= 2);
            return control === document.activeElement && !isOutlined;
        })
        .map(control => control.outerHTML.replace(/\\s+/g, " ").slice(0, 110));
    focused?.focus();
    return without;
}"""
# Behind text the browser paints a plate of the page's ground, on which text in a colour for another
# ground is not seen; unless the element keeps its colours.
_LOST_BY_FORCED_COLORS = """([scope]) => {
    const probe = document.body.appendChild(document.createElement("i"));
    const resolve = color => {
        probe.style.backgroundColor = color;
        return getComputedStyle(probe).backgroundColor;
    };
    const grounds = ["Canvas", "ButtonFace", "Field"].map(resolve);
    const groundOf = one => getComputedStyle(one).backgroundColor;
    const hasNone = one => /^rgba\\(.*, 0\\)$/.test(groundOf(one));
    const isShown = one => one.checkVisibility({visibilityProperty: true, opacityProperty: true});
    const describe = one => one.outerHTML.replace(/\\s+/g, " ").slice(0, 110);
    const problems = [];
    for (const one of document.querySelector(scope).querySelectorAll("*")) {
        if (one.closest("svg, .sr-only, iframe") || !isShown(one)) continue;
        const {forcedColorAdjust} = getComputedStyle(one);
        if ([...one.childNodes].some(node => node.nodeType === 3 && node.textContent.trim())) {
            let around = one;
            while (around && hasNone(around)) around = around.parentElement;
            const ground = around ? groundOf(around) : grounds[0];
            if (forcedColorAdjust !== "none" && !grounds.includes(ground))
                problems.push(`text on a plate over ${ground}: ${describe(one)}`);
        }
        if (one.matches("[aria-pressed=true], [aria-selected=true], a[aria-current]")
            && (hasNone(one) || grounds.includes(groundOf(one))))
            problems.push(`is not seen to be chosen: ${describe(one)}`);
    }
    probe.remove();
    return problems;
}"""
_STILL_MOVING = """() => document.getAnimations()
    .filter(({playState}) => playState === "running")
    .map(({effect}) => effect.target.outerHTML.slice(0, 110))"""


def each_poor_window(page: Page) -> Iterator[PoorWindow]:
    """Make the window each of them in turn; motion is reduced, and all is as before at the end."""
    session = page.context.new_cdp_session(page)
    before = page.viewport_size
    for window in POOR_WINDOWS:
        page.emulate_media(
            forced_colors="active" if window.has_forced_colors else "none", reduced_motion="reduce"
        )
        sizes = {"standard": window.type_px, "fixed": window.type_px}
        session.send("Page.setFontSizes", {"fontSizes": sizes})
        page.set_viewport_size(window.size)
        yield window
    page.emulate_media(forced_colors="none", reduced_motion="no-preference")
    if before is not None:
        page.set_viewport_size(before)
    session.detach()


def problems_in(page: Page, window: PoorWindow, scope: str = "body") -> list[str]:
    """Return what cannot be used in a poor window.

    Args:
        page: in this window.
        window: which one it is.
        scope: a CSS selector of what is looked at, unless a dialog is over the page.
    """
    problems: list[str] = page.evaluate(_OUT_OF_REACH, [scope, _CONTROLS])
    if window.has_forced_colors:
        unseen: list[str] = page.evaluate(_WITHOUT_FOCUS, [scope, _CONTROLS])
        problems += [f"focus is not seen: {control}" for control in unseen]
        problems += page.evaluate(_LOST_BY_FORCED_COLORS, [scope])
    moving: list[str] = page.evaluate(_STILL_MOVING)
    return problems + [f"moves: {element}" for element in moving]
