"""The report's page in a browser, as people see it."""

from pathlib import Path
from typing import Any

from playwright.sync_api import Page

from hexapods.experiments.report.page import page


def opened(tab: Page, folder: Path, summary: Any) -> list[str]:
    """Open a report from a file; return the addresses that the browser requested of others."""
    requested: list[str] = []
    tab.on("request", lambda request: requested.append(request.url))
    file = folder / "report.html"
    file.write_text(page(summary))
    tab.goto(file.as_uri())
    tab.locator("h1").wait_for()
    own_addresses = ("data:text/javascript;base64,", file.as_uri())
    return [url for url in requested if not url.startswith(own_addresses)]


def text_of(tab: Page) -> str:
    """Return all text of the page, also what is folded, with plain spaces."""
    tab.evaluate(
        "document.querySelectorAll('details').forEach((details) => { details.open = true; })"
    )
    return tab.locator("body").inner_text().replace("\xa0", " ")
