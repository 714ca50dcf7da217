"""The report's files: a self-contained page, CSV, figures and the summary."""

import csv
import io
import json
import re
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from playwright.sync_api import Page

from hexapods.domain.records import from_json
from hexapods.experiments import report
from hexapods.experiments.config import (
    ExperimentConfig,
)
from hexapods.experiments.presets import PRESETS
from hexapods.experiments.report.command import command
from hexapods.experiments.report.files import report_files, write_files
from hexapods.experiments.report.page import page
from hexapods.experiments.report.trials_csv import trials_csv
from hexapods.experiments.summary import summarise
from hexapods.experiments.trial import TrialResult
from hexapods.runs.best_known import COVERAGE, DEFINITION
from tests.experiments.report.opened import opened, text_of
from tests.experiments.sample_experiments import (
    ROBOTS,
    Results,
    around,
    config,
    sample_results,
    summary_of,
    walked,
)
from tests.promises.length import only_whole

MAX_BYTES = 2_000_000
NASTY = '</script><img src=x onerror="alert(1)"><script>alert(2)</script>'
RIGHT_TO_LEFT = "\u202egnorw"
LRO = "left-right-origin"


def small(experiment: str = "table1", **options: Any) -> tuple[Any, Results]:
    """Return summary and results of one gait in one case with three seeds."""
    only = {"gaits": (LRO,), "observations": ("measured",), "robots": ROBOTS[:1], **options}
    tried = config(experiment, seeds=3, **only)
    results = sample_results(tried, lambda _: around(0.3))
    return summarise(tried, results), results


@pytest.mark.parametrize(
    "experiment",
    [
        pytest.param("table1", marks=only_whole),
        pytest.param("figure4", marks=pytest.mark.promises),
    ],
)
def test_a_whole_report_of_thirty_seeds_is_small_enough_to_commit(experiment: str) -> None:
    tried = config(experiment, seeds=30)
    results = sample_results(tried, lambda _: around(0.3, 0.2))
    files = dict(report_files(summarise(tried, results), results))
    assert sorted(files) == ["report.html", "summary.json", "trials.csv"]
    assert sum(map(len, files.values())) < MAX_BYTES


def test_the_same_trials_give_the_same_bytes() -> None:
    summary, results = small()
    assert list(report_files(summary, results)) == list(report_files(summary, results))


def test_an_older_report_is_replaced(tmp_path: Path) -> None:
    summary, results = small()
    (tmp_path / "report.html").write_text("older")
    written = write_files(tmp_path, report_files(summary, results))
    assert written == tmp_path / "report.html"
    assert written.read_text() == page(summary)
    files = {
        file.relative_to(tmp_path).as_posix() for file in tmp_path.rglob("*") if file.is_file()
    }
    assert files == {"report.html", "summary.json", "trials.csv"}


def test_the_csv_has_a_row_for_every_block_of_every_trial() -> None:
    tried, results = walked("figure4", 5, gaits=(LRO,))
    summary = summarise(tried, results)
    rows = _rows(_csv(summary, results))
    learners = [row for row in rows if row["role"] == "learner"]
    assert len(learners) == 2 * 2 * 5 * 8  # readings, in blocks and in one go, seeds, walks
    first = [row for row in learners if row["trial"] == learners[0]["trial"]]
    assert [int(row["practised_steps"]) for row in first] == list(range(250, 2001, 250))
    assert [float(row["distance_m"]) for row in first] == list(
        results[first[0]["trial"]].distances_m
    )
    assert {row["alpha"] for row in learners} == {"0.3"}


def test_trials_without_a_result_are_named_on_the_page_and_in_the_csv(
    shown: Page, tmp_path: Path
) -> None:
    tried = config("table1", seeds=3, gaits=(LRO,))
    results = sample_results(tried, lambda _: around(0.3))
    bad, worse = (f"{LRO}/measured/stiff/q-learning/500#{n}" for n in (1, 2))
    results[bad] = TrialResult(failure="=the physics diverged")
    del results[worse]
    summary = summarise(tried, results, {worse: "it killed its worker three times"})
    opened(shown, tmp_path, summary)
    text = text_of(shown)
    trial = "Q-learning, 500 steps, Left-right, opposite, feet measured, stiff robot, seed"
    assert f"{trial} 1 failed: =the physics diverged" in text
    assert f"{trial} 2 was set aside: it killed its worker three times" in text
    rows = {row["trial"]: row for row in _rows(_csv(summary, results))}
    assert (
        rows[bad]["failure"] == "'=the physics diverged"
    )  # escaped, so that a spreadsheet does not evaluate it
    assert rows[bad]["distance_m"] == ""
    assert rows[worse]["failure"] == "set aside: it killed its worker three times"


def test_summary_json_is_the_given_summary() -> None:
    summary, results = small("sweep", alpha=(0.1, 0.3))
    name, content = next(report_files(summary, results))
    assert name == "summary.json"
    assert json.loads(content) == summary


@pytest.fixture
def shown(page: Page) -> Page:
    """A tab that fails its test on any console message, script error or dialog."""
    page.on("console", lambda message: pytest.fail(message.text, pytrace=False))
    page.on("pageerror", lambda error: pytest.fail(str(error), pytrace=False))
    page.on("dialog", lambda dialog: pytest.fail(dialog.message, pytrace=False))
    return page


@pytest.mark.parametrize("experiment", ["table1", "figure4", "sweep"])
def test_the_page_opens_from_a_file_without_a_request(
    shown: Page, tmp_path: Path, experiment: str
) -> None:
    summary, _ = small(experiment)
    assert opened(shown, tmp_path, summary) == []
    assert shown.locator("h1").inner_text() == PRESETS[experiment].heading
    text = text_of(shown)
    for words in (
        command(summary["config"]),
        "Wilson intervals",
        f"{summary['trials']['done']} of {summary['trials']['total']} done",
        f"numpy {summary['versions']['numpy']}",
    ):
        assert words in text


@pytest.mark.parametrize(
    ("experiment", "simulator", "is_known"),
    [
        *((name, "mujoco", True) for name in ("table1", "figure4", "sweep")),
        # Of a sweep, nothing is said of a distance that no setting has.
        *((name, "kinematic", False) for name in ("table1", "figure4")),
    ],
)
def test_the_best_known_distance_has_its_definition(
    shown: Page, tmp_path: Path, experiment: str, simulator: str, is_known: bool
) -> None:
    opened(shown, tmp_path, small(experiment, simulator=simulator)[0])
    text = text_of(shown)
    assert DEFINITION in text
    assert (COVERAGE in text) == (not is_known)
    assert ("0.51 m" in text) == is_known


def test_the_table_has_the_papers_values_in_three_units(shown: Page, tmp_path: Path) -> None:
    opened(shown, tmp_path, small(robots=ROBOTS)[0])
    table = shown.get_by_role("table", name="Distance at time-out and total distance")
    for column in ("Q-learning, 500 steps", "Q-learning, 1000 steps", "Greedy", "Two-step"):
        assert table.get_by_role("columnheader", name=column, exact=True).count() == 1
    assert "paper 0.25 m" in table.inner_text().replace("\xa0", " ")
    assert "paper: unfinished" in table.inner_text()
    assert (
        table.get_by_role("rowheader", name="Left-right, opposite (LeftRight-Origin)").count() == 1
    )
    assert "†" in table.inner_text()
    total = table.get_by_role("row", name="Total").locator("[data-label=Greedy]")
    for unit, value in (("metres", "0.50"), ("half grid sides", "25.0"), ("relative", "100")):
        shown.get_by_role("button", name=unit).click()
        assert total.inner_text().startswith(value)


def test_a_claim_has_its_verdict_in_every_case_and_its_evidence(
    shown: Page, tmp_path: Path
) -> None:
    summary = summary_of("table1", lambda _: around(0.3), seeds=6)
    opened(shown, tmp_path, summary)
    text = text_of(shown)
    assert shown.locator(".claims .verdict").count() == sum(
        1 + len(claim["where"]) for claim in summary["claims"]
    )
    for claim in summary["claims"]:
        for words in (claim["claim"], claim["criterion"], *(c["evidence"] for c in claim["where"])):
            assert as_shown(words) in text
    assert headings_below(shown, "The paper’s claims over all seeds") == [
        as_shown(claim["claim"]) for claim in summary["claims"]
    ]
    assert headings_below(shown, "Findings") == [section["heading"] for section in summary["story"]]
    assert "2000 resamples" in text


def as_shown(words: str) -> str:
    """Return a text of a summary as `text_of` has it; numbers below 10,000 are not grouped."""
    return re.sub(r"(?<=\d),(?=\d{3})", "", words.replace("\xa0", " "))


def headings_below(tab: Page, title: str) -> list[str]:
    """Return the headings of the third level in the section of a heading of the second."""
    section = tab.get_by_role("region", name=title)
    assert section.get_by_role("heading", level=2, name=title).count() == 1
    return section.get_by_role("heading", level=3).all_inner_texts()


@pytest.mark.parametrize("experiment", ["table1", "figure4", "sweep", "league"])
def test_every_table_has_a_caption_and_every_switch_a_title_on_paper(
    shown: Page, tmp_path: Path, experiment: str
) -> None:
    agents = {"agents": ("q-learning", "sarsa")} if experiment in ("sweep", "league") else {}
    opened(shown, tmp_path, small(experiment, robots=ROBOTS, **agents)[0])
    assert shown.locator("table").count() > 0
    assert shown.locator("table:not(:has(> caption))").count() == 0
    places = [
        button.inner_text() for button in shown.get_by_label("Place").get_by_role("button").all()
    ]
    assert len(places) == (0 if experiment == "sweep" else 2)
    shown.evaluate("dispatchEvent(new Event('beforeprint'))")
    for place in places:
        assert shown.get_by_role("heading", level=3, name=place, exact=True).count() >= 1
    shown.evaluate("dispatchEvent(new Event('afterprint'))")
    assert (
        shown.get_by_role("heading", level=3, name="Feet measured, stiff", exact=True).count() == 0
    )


@pytest.mark.parametrize("experiment", ["table1", "sweep"])
def test_a_table_with_strips_is_downloaded_as_svg_and_png(
    shown: Page, tmp_path: Path, experiment: str
) -> None:
    swept = {"alpha": (0.1, 0.3)} if experiment == "sweep" else {}
    opened(shown, tmp_path, small(experiment, **swept)[0])
    menu = shown.get_by_label(re.compile("^Download "))
    content = {}
    for kind in ("SVG", "PNG"):
        menu.first.click()
        with shown.expect_download() as download:
            shown.get_by_role("button", name=f"Download as {kind}").first.click()
        content[kind] = Path(download.value.path()).read_bytes()
        menu.first.click()
    assert content["PNG"].startswith(b"\x89PNG")
    picture = ElementTree.fromstring(content["SVG"])
    texts = ["".join(text.itertext()) for text in picture.findall(".//{*}text")]
    assert {"one seed", "0.00\u00a0m"} <= set(texts)
    strips = {"table1": 4, "sweep": 2}[experiment]
    dots = picture.findall(".//{*}circle")
    assert len(dots) == strips * 3 + 1  # seeds, and the one of the legend
    if experiment == "table1":
        assert {"Left-right, opposite (LeftRight-Origin)", "Q-learning, 500 steps"} <= set(texts)


def test_only_modules_of_the_page_are_run(page: Page, tmp_path: Path) -> None:
    opened(page, tmp_path, small("sweep")[0])
    forged = """new Promise((resolve) => {
        addEventListener("securitypolicyviolation", (event) => resolve(event.effectiveDirective));
        const script = Object.assign(document.createElement("script"), {
            type: "module", src: "data:text/javascript,window.isForged = true",
        });
        document.body.append(script);
    })"""
    assert page.evaluate(forged) == "script-src-elem"
    assert page.evaluate("window.isForged") is None


def test_no_module_of_the_report_names_an_experiment() -> None:
    folder = Path(report.__file__).parent
    named = re.compile("|".join(rf"['\"]{name}['\"]" for name in PRESETS))
    assert [path.name for path in folder.glob("*.py") if named.search(path.read_text())] == []


def test_the_page_does_not_scroll_horizontally(shown: Page, tmp_path: Path) -> None:
    for experiment in ("table1", "figure4", "sweep"):
        opened(shown, tmp_path, small(experiment)[0])
        for width in (390, 1200):
            shown.set_viewport_size({"width": width, "height": 800})
            assert shown.evaluate("document.documentElement.scrollWidth") == width


def test_names_are_text_on_the_page(shown: Page, tmp_path: Path) -> None:
    summary, _ = small("figure4")
    for field in ("settings", "curves", "pooled"):
        for entry in summary[field]:
            entry["agent"] = entry["agent"].replace("q-learning", NASTY)
            entry["gait"] = NASTY
            entry["robot"] = NASTY
    summary["trials"]["set_aside"] = [{"key": NASTY, "reason": RIGHT_TO_LEFT}]
    summary["trials"]["failed"] = 1
    summary["versions"][NASTY] = NASTY
    scripts = page(small("figure4")[0]).count("<script")
    assert opened(shown, tmp_path, summary) == []
    assert shown.locator("img").count() == 0
    assert shown.locator("script").count() == scripts
    text = text_of(shown)
    assert f"{NASTY} was set aside: {RIGHT_TO_LEFT}" in text
    assert "numpy" in text


def test_the_page_prints_in_light_colours_with_all_that_is_folded(
    shown: Page, tmp_path: Path
) -> None:
    shown.emulate_media(color_scheme="dark")
    opened(shown, tmp_path, small()[0])
    panel = "getComputedStyle(document.querySelector('.report')).backgroundColor"
    assert shown.evaluate(panel) == "rgb(21, 26, 33)"
    shown.emulate_media(media="print", color_scheme="dark")
    assert shown.evaluate("getComputedStyle(document.querySelector('h1')).color") == (
        "rgb(20, 24, 31)"
    )
    assert shown.locator(".report-tools .segments").first.is_hidden()
    shown.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert shown.locator(".claims details:not([open])").count() == 0


def test_an_experiment_without_trials_has_a_page(shown: Page, tmp_path: Path) -> None:
    opened(shown, tmp_path, summarise(config("sweep", seeds=3), {}))
    assert "0 of" in text_of(shown)


def _csv(summary: Any, results: Results) -> bytes:
    aside = {entry["key"]: entry["reason"] for entry in summary["trials"]["set_aside"]}
    return trials_csv(from_json(ExperimentConfig, summary["config"]), results, aside)


def _rows(content: bytes) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(content.decode(), newline="")))
