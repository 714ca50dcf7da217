"""The picture of a race, in pixels: robots fill it, none is cut, and nothing lies over another.

Measured is what the 3D view draws: all vertices of the robots' meshes, projected by its camera. The
box of a robot is around its vertices; the area of boxes is their sum, a share of the picture.
"""

import re
from itertools import combinations, pairwise
from typing import Any, Literal, NamedTuple

import httpx2
import pytest
from playwright.sync_api import Frame, Page, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving, finished
from tests.running_app import wait_until

pytestmark = [pytest.mark.looks_at_3d, pytest.mark.timeout(400)]

WALK = {"gait": "left-right-origin", "simulator": "kinematic"}
SIZES = [(1280, 720), (1440, 900), (1920, 1080), (390, 844)]
_THEMES: tuple[Literal["light", "dark"], ...] = ("light", "dark")

MEASURE = """() => {
    const {camera, canvas, nodeRefFromName} = __viserMutable;
    const floats = (bytes) => new Float32Array(
        bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength));
    const toScreen = nodeRefFromName["/world/run"].matrixWorld.clone()
        .premultiply(camera.matrixWorldInverse).premultiply(camera.projectionMatrix);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    const robots = {};
    const batch = /^\\/world\\/run\\/robots2?\\/\\d+\\/(?:torso|legs((?:-\\d+)+))$/;
    for (const [name, {message}] of Object.entries(__viserSceneTree.getState())) {
        const match = batch.exec(name);
        if (!match || message?.type !== "BatchedMeshesMessage") continue;
        const [vertices, places, turns] = ["vertices", "batched_positions", "batched_wxyzs"]
            .map((part) => floats(message.props[part]));
        const links = match[1] ? match[1].split("-").length - 1 : 1;
        for (let n = 0; n < places.length / 3; n += 1) {
            const robot = robots[Math.floor(n / links)] ??= {xs: [], ys: [], points: []};
            const [w, x, y, z] = turns.slice(4 * n, 4 * n + 4);
            const turn = camera.quaternion.clone().set(x, y, z, w);
            for (let at = 0; at < vertices.length; at += 3) {
                const point = camera.position.clone().fromArray(vertices, at).applyQuaternion(turn);
                point.add(camera.position.clone().fromArray(places, 3 * n)).applyMatrix4(toScreen);
                const place = [(point.x + 1) / 2 * width, (1 - point.y) / 2 * height];
                robot.points.push(place);
            }
        }
    }
    const labels = [...document.querySelectorAll(".labels > div:not([hidden])")].map((element) => {
        const {left, top, right, bottom} = element.getBoundingClientRect();
        return {text: element.innerText, box: [left, top, right, bottom]};
    });
    return {
        width, height, labels,
        robots: Object.values(robots).map(({points}) => {
            const [xs, ys] = [0, 1].map((axis) => points.map((point) => point[axis]));
            const [least, most] = [Math.min, Math.max];
            return {points, box: [least(...xs), least(...ys), most(...xs), most(...ys)]};
        }),
    };
}"""
"""Vertices and boxes of the robots and the boxes of the labels in the picture [px]."""

OVER = """picture => {
    const place = picture.getBoundingClientRect();
    const all = ".chip, .stage-notes > *, .directed-camera, .away-note";
    return [...picture.querySelectorAll(all)].filter((element) => element.checkVisibility())
        .map((element) => [element, element.getBoundingClientRect()])
        .map(([element, {left, top, right, bottom}]) => ({
            text: element.innerText,
            box: [left - place.left, top - place.top, right - place.left, bottom - place.top],
        })).filter(({box}) => box[2] > box[0]);
}"""
"""Texts and boxes of what the page shows over the picture, in pixels of it."""

Box = list[float]


class Seen(NamedTuple):
    """A picture, measured.

    Attributes:
        area: sum of the boxes of the robots, as a share of the picture.
        cut: robots that are not whole in the picture.
        covers: pairs of what lies over each other, in words.
        texts: of the labels that are shown.
    """

    area: float
    cut: list[int]
    covers: list[str]
    texts: list[str]


def measured(view: Frame, page: Page) -> Seen:
    """Measure the picture as it is drawn now."""
    picture: dict[str, Any] = view.evaluate(MEASURE)
    over = page.locator(".picture").evaluate(OVER)
    width, height = picture["width"], picture["height"]
    boxes = [robot["box"] for robot in picture["robots"]]
    area = sum((right - left) * (bottom - top) for left, top, right, bottom in boxes)
    cut = [
        lane
        for lane, (left, top, right, bottom) in enumerate(boxes)
        if left < 0 or top < 0 or right > width or bottom > height
    ]
    covers = [
        f"{a['text']!r} and {b['text']!r}"
        for a, b in combinations([*picture["labels"], *over], 2)
        if intersect(a["box"], b["box"])
    ]
    covers += [
        f"{words['text']!r} and robot {lane}"
        for words in [*picture["labels"], *over]
        for lane, robot in enumerate(picture["robots"])
        if any(has(words["box"], point) for point in robot["points"])
    ]
    return Seen(
        area / (width * height), cut, covers, [label["text"] for label in picture["labels"]]
    )


def intersect(a: Box, b: Box) -> bool:
    """Whether two boxes have pixels in common."""
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


def has(box: Box, point: list[float]) -> bool:
    """Whether a point is in a box."""
    return box[0] < point[0] < box[2] and box[1] < point[1] < box[3]


PLACE = "() => __viserMutable.camera.matrixWorld.elements.map((number) => number.toFixed(4)).join()"


def at_rest(view: Frame, page: Page) -> None:
    """Wait until the camera has come to rest."""
    places: list[str] = []

    def stays() -> bool:
        page.wait_for_timeout(400)
        places.append(view.evaluate(PLACE))
        return len(places) > 2 and len({*places[-3:]}) == 1

    wait_until(stays)


@pytest.fixture(scope="module")
def race(shared_server: Serving) -> dict[str, Any]:
    """A race of three robots that get far apart."""
    practice = {"steps": 200, "seed": 1}
    lanes = [
        {"agent": "q-learning", "training": practice},
        {"agent": "greedy"},
        {"agent": "two-step"},
    ]
    with shared_server.api() as api:
        return finished(api, "races", {**WALK, "steps": 30, "seed": 1, "lanes": lanes})


def time_out_of(api: httpx2.Client, race: dict[str, Any]) -> float:
    """Return the time-out of a race by the paper clock [s]."""
    plan = api.get(f"runs/{race['id']}/replay", params={"clock": "paper"}).json()
    return float(next(mark["time_s"] for mark in plan["marks"] if mark["kind"] == "time-out"))


def test_over_a_whole_race_no_robot_is_cut_and_nothing_covers_another(
    dashboard: Dashboard, shared_server: Serving, race: dict[str, Any]
) -> None:
    page = dashboard.page
    with shared_server.api() as api:
        time_out_s = time_out_of(api, race)
    dashboard.open(shared_server.link(run=race["id"], t="0", depth="try"))
    view = picture_of(page)
    for number, share in enumerate((0.0, 0.3, 0.65, 1.0)):
        go_to(page, share, time_out_s)
        for other, (width, height) in enumerate(SIZES):
            # Each size in both themes.
            theme = _THEMES[(number + other) % 2]
            page.emulate_media(color_scheme=theme)
            page.set_viewport_size({"width": width, "height": height})
            at_rest(view, page)

            seen = measured(view, page)
            about = f"{share:.0%} of the race at {width} × {height}, {theme}"
            assert (about, seen.cut, seen.covers) == (about, [], [])
            names = [text.split("\n")[0] for text in seen.texts]
            for name in ("Q-learning", "Greedy", "Two-step"):
                expected = rf"\d\. {name}" if share == 1 else name
                assert any(re.fullmatch(expected, text) for text in names), (about, names)


def go_to(page: Page, share: float, time_out_s: float) -> None:
    """Go to a share of the race, by the bar of the replay; its end is the photo finish."""
    slider = page.get_by_role("slider", name="Moment of your replay")
    if share == 1:
        slider.press("End")
    else:
        slider.fill(f"{share * time_out_s:.2f}")


class Window(NamedTuple):
    """A window, the size of the stage in it without the panel, and what robots fill at least."""

    size: tuple[int, int]
    stage: tuple[int, int]
    least: float


# Those in which the stage has the sizes of the prototype's.
WINDOWS = [Window((1296, 844), (1280, 720), 0.35), Window((390, 844), (390, 700), 0.45)]
_ALONE = (
    ".stage { position: fixed !important; inset: 0 0 auto; height: 700px !important; z-index: 9; }"
)
"""On a phone the stage is that high only in a window that shows nothing else."""


@pytest.mark.parametrize("window", WINDOWS, ids=["1280x720", "phone"])
def test_robots_fill_the_picture_in_the_race_and_at_the_finish(
    dashboard: Dashboard, shared_server: Serving, race: dict[str, Any], window: Window
) -> None:
    page = dashboard.page
    page.set_viewport_size({"width": window.size[0], "height": window.size[1]})
    with shared_server.api() as api:
        time_out_s = time_out_of(api, race)
    dashboard.open(shared_server.link(run=race["id"], t="3", hidden="panel,card"))
    view = picture_of(page)
    if window.stage[1] > window.stage[0]:
        page.add_style_tag(content=_ALONE)
    for share in (0.5, 1.0):
        go_to(page, share, time_out_s)
        at_rest(view, page)
        box = dashboard.box(".picture iframe")
        assert (round(box["width"]), round(box["height"])) == window.stage

        seen = measured(view, page)
        assert seen.area >= window.least, f"at {share:.0%} of the race"
        assert seen.cut == []


def test_no_robot_is_cut_while_the_race_runs(
    dashboard: Dashboard, shared_server: Serving, race: dict[str, Any]
) -> None:
    page = dashboard.page
    dashboard.open(shared_server.link(run=race["id"], depth="try"))
    view = picture_of(page)

    cut = []
    for _ in range(8):
        page.wait_for_timeout(500)
        cut += measured(view, page).cut
    assert cut == []


def picture_of(page: Page, robots: int = 3) -> Frame:
    """Return the frame of the 3D view, once so many robots and their labels are in it."""
    view = page.frame(url=re.compile("/viewer/"))
    assert view is not None
    labels = view.locator(".labels > div:not([hidden])")
    wait_until(lambda: labels.count() >= robots)
    return view


def test_who_turns_the_picture_has_the_camera_until_a_press_brings_it_back(
    dashboard: Dashboard, shared_server: Serving, race: dict[str, Any]
) -> None:
    page = dashboard.page
    dashboard.open(shared_server.link(run=race["id"], t="4"))
    view = picture_of(page)
    at_rest(view, page)
    place = "() => __viserMutable.camera.position.toArray()"
    directed = view.evaluate(place)
    back = dashboard.button("Directed camera")
    expect(back).to_have_count(0)

    box = dashboard.box(".picture iframe")
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] - 40
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 160, y, steps=4)
    page.mouse.up()
    expect(back).to_be_visible()
    at_rest(view, page)
    turned = view.evaluate(place)
    assert turned != pytest.approx(directed, abs=0.05)
    assert dashboard.violations("button-name", "color-contrast") == []

    page.keyboard.press("c")
    expect(back).to_have_count(0)
    at_rest(view, page)
    assert view.evaluate(place) == pytest.approx(directed, abs=0.02)

    # Another side, a robot from close, and a free camera, which stays where it is.
    page.keyboard.press("v")
    at_rest(view, page)
    assert view.evaluate(place) != pytest.approx(directed, abs=0.05)
    page.keyboard.press("2")
    expect(page).to_have_url(re.compile("camera=2"))
    at_rest(view, page)
    close = view.evaluate(place)
    page.keyboard.press("0")
    expect(back).to_be_visible()
    assert view.evaluate(place) == pytest.approx(close, abs=0.02)
    back.click()
    expect(back).to_have_count(0)
    at_rest(view, page)
    assert view.evaluate(place) == pytest.approx(directed, abs=0.02)


PLACES = """async ([pictures, key]) => {
    const places = [];
    while (places.length < pictures) {
        await new Promise(requestAnimationFrame);
        const {camera, nodeRefFromName} = __viserMutable;
        const toRun = nodeRefFromName["/world/run"].matrixWorld.clone().invert();
        const place = camera.position.clone().applyMatrix4(toRun).toArray();
        places.push(place.map((metres) => metres.toFixed(2)).join(" "));
        if (places.length === 3 && key) {
            dispatchEvent(new KeyboardEvent("keydown", {key, bubbles: true}));
        }
    }
    return places;
}"""
"""Where the camera is in each of some pictures, of the run [m]; a key is pressed in the third."""


@pytest.mark.parametrize("motion", ["reduce", "no-preference"])
def test_without_motion_the_camera_cuts_and_stands(
    dashboard: Dashboard,
    shared_server: Serving,
    race: dict[str, Any],
    motion: Literal["reduce", "no-preference"],
) -> None:
    page = dashboard.page
    page.emulate_media(reduced_motion=motion)
    dashboard.open(shared_server.link(run=race["id"], t="0"))
    view = picture_of(page)
    at_rest(view, page)
    # From its first shot it cuts in any case.
    moves_within(view, 12, "v")
    at_rest(view, page)
    moves = {"another side": moves_within(view, 24, "v")}
    at_rest(view, page)
    dashboard.button("Play your replay").click()
    moves["race"] = moves_within(view, 24)
    page.get_by_role("slider", name="Moment of your replay").press("End")
    moves["finish"] = moves_within(view, 12)

    if motion == "reduce":
        assert moves["another side"] == 1
        # It stands while robots walk, and is put elsewhere where they would leave the picture.
        assert 1 <= moves["race"] <= 4
        assert moves["finish"] <= 1
    else:
        assert moves["another side"] > 2
        assert moves["race"] > 4


def moves_within(view: Frame, pictures: int, key: str = "") -> int:
    """Return how often the camera is elsewhere than in the picture before, pressing a key."""
    places: list[str] = view.evaluate(PLACES, [pictures, key])
    return sum(a != b for a, b in pairwise(places))  # whole numbers


def test_the_picture_is_said_to_load_until_robots_are_in_it(
    dashboard: Dashboard, shared_server: Serving, race: dict[str, Any]
) -> None:
    page = dashboard.page
    page.add_init_script(FIRST_PICTURE)
    dashboard.open(shared_server.link(run=race["id"], t="4"))
    expect(page.get_by_text("Loading the picture…")).to_have_count(0)
    assert page.evaluate("firstPicture") == {"robots": True, "isAimed": True}


FIRST_PICTURE = """new MutationObserver(() => {
    const isLoading = document.querySelector(".placeholder") !== null;
    if (!window.wasLoading || isLoading) {
        window.wasLoading ||= isLoading;
        return;
    }
    const {nodeRefFromName, camera} = document.querySelector("iframe").contentWindow.__viserMutable;
    window.firstPicture ??= {
        robots: Object.keys(nodeRefFromName).some((name) => /run\\/robots/.test(name)),
        isAimed: camera.position.length() < 4,
    };
}).observe(document, {childList: true, subtree: true});"""
"""Keeps what is in the 3D view when the page no longer says that it loads."""
