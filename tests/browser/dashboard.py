"""The dashboard as the tests see it, by the words that a person reads on it."""

import hashlib
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from playwright.sync_api import ConsoleMessage, FloatRect, FrameLocator, Locator, Page, expect

PATIENCE_MS = 60_000
"""A race in software WebGL beside the browser that shows it, on two cores, takes its time."""
_RULES_OF_COLORS = ("color-contrast", "link-in-text-block")
"""Those of axe's rules for which another theme is another page."""

expect.set_options(timeout=PATIENCE_MS)

_AXE = Path(__file__).with_name("vendor") / "axe.min.js"
# Those that end: a colour on its way to another is no colour of the page.
_TRANSITIONS_HAVE_ENDED = """() => Promise.all(document.getAnimations()
    .filter(({effect}) => effect.getComputedTiming().endTime !== Infinity)
    .map(animation => animation.finished.catch(() => {})))"""
# A box to tick is met by its label too, and a thin mark by what lies around it (its `::after`). Of
# links within a sentence the text gives the height.
_TOO_SMALL = """least => {
    const controls = "a[href], button, input, select, textarea, summary, [role=slider], [role=tab]";
    const isShown = one => one.checkVisibility({visibilityProperty: true});
    const isInSentence = one => getComputedStyle(one).display.startsWith("inline")
        && [...one.parentElement.childNodes].some(n => n.nodeType === 3 && n.textContent.trim());
    const around = one => {
        const {content, position, width, height} = getComputedStyle(one, "::after");
        const isThere = content !== "none" && position === "absolute";
        return {width: isThere ? parseFloat(width) : 0, height: isThere ? parseFloat(height) : 0};
    };
    const sizeOf = one => {
        const boxes = [one, ...(one.labels ?? [])].map(each => each.getBoundingClientRect());
        const all = [...boxes, around(one)];
        return ["width", "height"].map(side => Math.max(...all.map(box => box[side])));
    };
    return [...document.querySelectorAll(controls)]
        .filter(one => isShown(one) && !isInSentence(one))
        .map(one => [one, sizeOf(one)])
        .filter(([, sizes]) => Math.min(...sizes) < least - 0.5)
        .map(([one, sizes]) =>
            `${one.outerHTML.slice(0, 120)}: ${sizes.map(size => size.toFixed(1)).join(" x ")}`);
}"""
_UNFOLD = """() => [...document.querySelectorAll("details:not([open])")]
    .forEach(one => one.toggleAttribute("open", one.toggleAttribute("data-unfolded", true)))"""
_FOLD = """() => document.querySelectorAll("[data-unfolded]").forEach(one =>
    ["open", "data-unfolded"].forEach(name => one.removeAttribute(name)))"""
# A route of Playwright would stop each request of the page, to look at its address.
WITHOUT_3D = """Object.defineProperty(HTMLIFrameElement.prototype, "src", {set() {}})"""
HAS_A_PICTURE = [{"type": "hexapods:status", "status": word} for word in ("connected", "drawn")]
_STATUS = re.compile(r"status of (\d+)")
"""Part of Chromium's message about an answer of 400 and above."""
_METRES = re.compile(r"−?\d+\.\d\d\sm")


class Dashboard:
    """A page of it, and what went wrong on it."""

    def __init__(self, page: Page, *, has_3d: bool = True) -> None:
        """Listen to what the page complains about; nothing is opened.

        Args:
            page: an empty tab.
            has_3d: whether its 3D view loads. Most tests do not look at it, and drawn in software
                it takes more time than all the rest of the page.
        """
        self.page = page
        self._has_3d = has_3d
        if not has_3d:
            page.add_init_script(WITHOUT_3D)
        self.complaints: list[str] = []
        page.set_default_timeout(PATIENCE_MS)
        page.on("pageerror", lambda error: self.complaints.append(str(error)))
        page.on("console", self._heard)

    def open(self, address: str) -> None:
        """Open it, and wait until it is connected and has a picture, if it is to have one."""
        self.page.goto(address)
        expect(self.connection).to_contain_text("connected")
        if self._has_3d:
            self.wait_for_stage()

    def stand_in_for_stage(self, *messages: Mapping[str, object]) -> None:
        """Say what the 3D view says in a page that loads none; by default that it has a picture."""
        self.page.frame_locator("iframe").locator("html").wait_for(state="attached")
        [_, view] = self.page.frames
        for message in messages or HAS_A_PICTURE:
            view.evaluate("message => parent.postMessage(message, '*')", message)

    def wait_for_stage(self) -> None:
        """Wait until the 3D client has its stream."""
        # Other views than that of the race hide it.
        stage = self.page.get_by_role("region", name="Stage", exact=True, include_hidden=True)
        expect(stage).to_have_attribute("data-status", "connected")

    @property
    def primary(self) -> Locator:
        """The one big button."""
        return self.page.locator("button.primary")

    def button(self, name: str) -> Locator:
        """A button by its whole name."""
        return self.page.get_by_role("button", name=name, exact=True)

    def group(self, name: str) -> Locator:
        """A group of elements by its whole name."""
        return self.page.get_by_role("group", name=name, exact=True)

    @property
    def connection(self) -> Locator:
        """Whether the page is connected, and how many watch; the presenter view hides it."""
        return self.page.get_by_role("group", name="Connection", exact=True, include_hidden=True)

    @property
    def actions(self) -> Locator:
        """The primary button, what can be done with the runs at work, and their progress."""
        return self.group("Actions")

    @property
    def labels(self) -> Locator:
        """Labels over the picture: the run, its conditions and its speed."""
        return self.group("Labels of the picture")

    @property
    def shown_run(self) -> Locator:
        """The label of the run in the picture."""
        return self.group("Shown run")

    @property
    def notes(self) -> Locator:
        """Notes on the run in the picture: how it ended, and what comes next."""
        return self.group("Notes on the shown run")

    @property
    def view(self) -> FrameLocator:
        """The 3D view in its frame."""
        return self.page.get_by_title("The robots on the track, in 3D").content_frame

    def choose_depth(self, title: str) -> None:
        """Show as much as Watch, Try or Study do."""
        self.group("Depth").get_by_role("button", name=title, exact=True).click()

    def open_tab(self, title: str) -> Locator:
        """Open a tab of the panel, and return what it shows."""
        self.page.get_by_role("tab", name=title, exact=True).click()
        return self.page.get_by_role("tabpanel", name=title, exact=True)

    def unfold(self, *titles: str) -> None:
        """Open groups of settings of the open tab by their titles."""
        for title in titles:
            self.panel.locator("summary").get_by_text(title, exact=True).click()

    @property
    def panel(self) -> Locator:
        """The panel: headline, tabs, content of the open tab, and actions."""
        return self.page.get_by_role("complementary", name="Panel", exact=True)

    @property
    def headline(self) -> Locator:
        """State of the race or the practice in a line, or the move that is explained."""
        return self.panel.locator("header").get_by_role("heading")

    @property
    def reason(self) -> Locator:
        """Why what the headline says is so."""
        return self.panel.locator("header").get_by_role("paragraph")

    @property
    def time(self) -> Locator:
        """The bar below the stage: the moment that is shown, what happened, and how to go there."""
        return self.group("Time")

    @property
    def moment(self) -> Locator:
        """The thumb of the time bar, of the stage that all share."""
        return self.page.get_by_role("slider", name="Moment that is shown", exact=True)

    @property
    def lesson(self) -> Locator:
        """The card of the lesson."""
        return self.page.get_by_role("region", name="Lesson", exact=True)

    @property
    def scoreboard(self) -> Locator:
        """The tab of the board: the standings or the lanes of the race to come, and a chart."""
        return self.page.get_by_role("region", name="Scoreboard", exact=True)

    @property
    def standings(self) -> Locator:
        """The scoreboard's table."""
        return self.scoreboard.get_by_role("table", name="Standings")

    @property
    def rows(self) -> Locator:
        """The scoreboard's lanes, the leader first; only their groups of rows have names."""
        return self.standings.get_by_role("rowgroup", name=re.compile("."))

    def distances(self) -> list[str]:
        """Return the texts of the scoreboard's column of distances."""
        texts: list[str] = self.rows.evaluate_all(
            "lanes => lanes.map(({rows: [row]}) => row.cells[2].innerText)"
        )
        return texts

    @property
    def start_list(self) -> Locator:
        """The lanes of the race to come."""
        return self.scoreboard.get_by_role("list", name="Lanes of the race").get_by_role("listitem")

    @property
    def experiment(self) -> Locator:
        """Which experiment the report is of, how far it is, and what can be done with it."""
        return self.page.get_by_role("region", name=re.compile("^Experiment: "))

    def experiment_state(self, state: str) -> Locator:
        """The word for the state of the experiment, if it is in that state, with how far it is."""
        return self.experiment.get_by_text(re.compile(rf"^{state}\b"))

    @property
    def runs(self) -> Locator:
        """The runs in the list and its groups, each headed by its name."""
        lists = self.page.get_by_role("list", name=re.compile("^Runs(: |$)"))
        return lists.get_by_role("listitem")

    @property
    def run_names(self) -> Locator:
        """The names in the list of runs."""
        return self.runs.get_by_role("heading")

    @property
    def details(self) -> Locator:
        """Details beside the list of runs: of one run, or of all that are selected."""
        return self.page.get_by_role("region", name="Details", exact=True)

    def picture(self) -> str:
        """A fingerprint of the robots' canvas, without what stands over it."""
        canvas = self.view.locator("canvas").first
        return hashlib.sha256(canvas.screenshot(timeout=PATIENCE_MS)).hexdigest()

    def eventually(self, condition: Callable[[], object], what: str) -> None:
        """Wait for something that no locator can say."""
        for _ in range(PATIENCE_MS // 250):
            if condition():
                return
            self.page.wait_for_timeout(250)
        raise AssertionError(f"not within {PATIENCE_MS / 1000:.0f} s: {what}")

    def has_figures(self, lanes: int = 3) -> bool:
        """Whether every lane has a distance."""
        shown = self.distances()
        return len(shown) == lanes and all(_METRES.fullmatch(distance) for distance in shown)

    def box(self, selector: str) -> FloatRect:
        """Return the place of the first element of a selector in the window [px]."""
        box = self.page.locator(selector).first.bounding_box()
        assert box is not None
        return box

    def scroll_width(self) -> int:
        """Width of the page, scrolled or not [px]."""
        width: int = self.page.evaluate("document.documentElement.scrollWidth")
        return width

    def violations(self, *only: str) -> list[str]:
        """Return axe's violations on the page, of these rules if any are named.

        viser's own page in the frame is left out.
        """
        if not self.page.evaluate("'axe' in window"):
            self.page.evaluate(_AXE.read_text("utf-8"))
        self.page.evaluate(_TRANSITIONS_HAVE_ENDED)
        # All rules are tried; only those that are kept get no list of where they are.
        rules = {"runOnly": list(only)} if only else {}
        options = {"iframes": False, "resultTypes": ["violations"], **rules}
        report = self.page.evaluate("options => axe.run(document, options)", options)
        return [f"{v['id']}: {n['html']}" for v in report["violations"] for n in v["nodes"]]

    def violations_in_both_themes(self) -> list[str]:
        """Return axe's violations, first of all rules and then of colours in the other theme."""
        self.page.emulate_media(color_scheme="light")
        violations = self.violations()
        self.page.emulate_media(color_scheme="dark")
        return violations + [
            f"dark: {violation}" for violation in self.violations(*_RULES_OF_COLORS)
        ]

    def small_targets(self, least_px: int) -> list[str]:
        """Return the controls that are smaller than they may be, in all that can be unfolded."""
        self.page.evaluate(_UNFOLD)
        controls: list[str] = self.page.evaluate(_TOO_SMALL, least_px)
        self.page.evaluate(_FOLD)
        return controls

    def get(self, path: str) -> Any:
        """Return the API's answer to this page."""
        return self.page.evaluate("path => fetch(path).then(r => r.json())", path)

    def _heard(self, message: ConsoleMessage) -> None:
        if message.type != "error":
            return
        if "Failed to load resource" not in message.text:
            self.complaints.append(message.text)
        elif status := _STATUS.search(message.text):
            self.complaints.append(f"{status[1]} {message.location['url']}")
