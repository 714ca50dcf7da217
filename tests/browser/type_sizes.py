"""Sizes of type on a page, as one reads it from afar."""

from playwright.sync_api import Page

# Each text that can be seen in a type that is too small, with its size.
_SMALL_TEXTS = """least => {
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    const small = [];
    while (walker.nextNode()) {
        const {parentElement, textContent} = walker.currentNode;
        const box = parentElement.getBoundingClientRect();
        const isSeen = parentElement.checkVisibility({visibilityProperty: true})
            && box.width > 2 && box.height > 2 && !parentElement.closest("script, style, option");
        // Text of a drawing is scaled with it.
        const view = parentElement.ownerSVGElement?.getScreenCTM()?.a ?? 1;
        const size = parseFloat(getComputedStyle(parentElement).fontSize) * view;
        const isSmall = textContent.trim() && isSeen && size < least - 0.01;
        if (isSmall) small.push(`${size} px: ${textContent}`);
    }
    return small;
}"""


def small_texts(page: Page, least_px: float) -> list[str]:
    """Return the texts that can be seen in a type that is smaller than this."""
    texts: list[str] = page.evaluate(_SMALL_TEXTS, least_px)
    return texts
