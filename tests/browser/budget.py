"""Budget of a page: counts the controls and the words that it shows at once.

A control is a button, a link, a field, the head of a fold or a slider, whether it can be used now
or not. A word is what spaces separate in a text, without those of drawings and of the options of a
choice. Both count where they can be seen: not hidden, clipped or transparent, in the window, and
not scrolled out of what scrolls around them.
"""

from typing import NamedTuple

from playwright.sync_api import Page

_COUNT = """() => {
    const CONTROLS = "button, a[href], input, select, textarea, summary, [role=slider]";
    const UNSEEN_TEXTS = "script, style, option, noscript, svg";
    const LEAST_PX = 2;
    const meet = (one, other) => one.bottom > other.top + 1 && one.top < other.bottom - 1;
    const isSeen = (element) => {
        const box = element.getBoundingClientRect();
        const isDrawn = element.checkVisibility({visibilityProperty: true, opacityProperty: true});
        if (!isDrawn || box.width < LEAST_PX || box.height < LEAST_PX) return false;
        const {left, right, top, bottom} = box;
        if (right <= 0 || left >= innerWidth || bottom <= 0 || top >= innerHeight) return false;
        for (let around = element; around; around = around.parentElement) {
            const {clipPath, overflowY} = getComputedStyle(around);
            if (clipPath !== "none") return false;
            const clips = around !== element && ["auto", "scroll", "hidden"].includes(overflowY);
            if (clips && !meet(box, around.getBoundingClientRect())) return false;
        }
        return true;
    };
    const texts = [];
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    while (walker.nextNode()) {
        const {parentElement, textContent} = walker.currentNode;
        const isText = textContent.trim() && !parentElement.closest(UNSEEN_TEXTS);
        if (isText && isSeen(parentElement)) texts.push(textContent.trim());
    }
    return {
        controls: [...document.querySelectorAll(CONTROLS)].filter(isSeen).length,
        words: texts.flatMap((text) => text.split(/\\s+/)).length,
    };
}"""


class Shown(NamedTuple):
    """Controls and words that a page shows at once.

    Attributes:
        controls: how many there are.
        words: how many there are.
    """

    controls: int
    words: int


def shown_on(page: Page) -> Shown:
    """Count what can be seen of a page now."""
    return Shown(**page.evaluate(_COUNT))
