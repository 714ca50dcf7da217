"""Files and folders as a browser's page gets them: chosen by a button, dropped, or pasted."""

from collections.abc import Mapping
from pathlib import Path

from playwright.sync_api import Locator, expect

from tests.browser.dashboard import Dashboard

_HANDED = """([type, files]) => {
  const data = new DataTransfer();
  for (const [name, text] of Object.entries(files)) data.items.add(new File([text], name));
  const how = { bubbles: true, cancelable: true };
  if (type === "paste") {
    document.body.dispatchEvent(new ClipboardEvent("paste", { ...how, clipboardData: data }));
    return;
  }
  for (const kind of ["dragenter", "dragover", "drop"]) {
    document.body.dispatchEvent(new DragEvent(kind, { ...how, dataTransfer: data }));
  }
}"""


def hand(dashboard: Dashboard, files: Mapping[str, str], how: str = "drop") -> Locator:
    """Drop files on the page, or paste them; return the panel of the robot that is read."""
    dashboard.page.evaluate(_HANDED, [how, dict(files)])
    return panel_of(dashboard)


def choose_file(dashboard: Dashboard, path: Path) -> Locator:
    """Choose a file by the button; return the panel of the robot that is read."""
    dashboard.button("Your robots…").first.click()
    robots = dashboard.page.get_by_role("dialog", name="Your robots")
    robots.get_by_label("Robot from a file…").set_input_files(path)
    return panel_of(dashboard)


def panel_of(dashboard: Dashboard) -> Locator:
    """Return the panel of the robot that is read, once that is read or refused."""
    panel = dashboard.page.get_by_role("region", name="Robot from a file")
    expect(panel.get_by_role("heading", level=2)).to_be_visible()
    expect(panel.get_by_text("Reading")).to_have_count(0)
    return panel
