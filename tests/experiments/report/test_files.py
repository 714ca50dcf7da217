"""The report's files: a self-contained page, CSV, figures and the summary."""

import csv
import io
import json
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page

from hexapods.domain.records import from_json
from hexapods.experiments.config import (
    ExperimentConfig,
)
from hexapods.experiments.report.files import report_files, write_files
from hexapods.experiments.report.page import POLICY, page
from hexapods.experiments.report.trials_csv import trials_csv
from hexapods.experiments.summary import summarise
from hexapods.experiments.trial import TrialResult
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
NASTY = '<img src=x onerror="alert(1)"><script>alert(2)</script>'
LRO = "left-right-origin"


def small(experiment: str = "table1", **given: Any) -> tuple[Any, Results]:
    """Return summary and results of one gait in one case with three seeds."""
    only = {"gaits": (LRO,), "observations": ("measured",), "robots": ROBOTS[:1], **given}
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
    name = experiment
    figures = [f"figures/{name}.{kind}" for kind in ("png", "svg", "pdf")]
    assert sorted(files) == sorted(["report.html", "summary.json", "trials.csv", *figures])
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
    files = {one.relative_to(tmp_path).as_posix() for one in tmp_path.rglob("*") if one.is_file()}
    figures = {f"figures/table1.{kind}" for kind in ("png", "svg", "pdf")}
    assert files == {"report.html", "summary.json", "trials.csv", *figures}


def test_the_table_has_the_papers_shape_in_three_units() -> None:
    text = page(small(robots=ROBOTS)[0])
    for column in ("Q-500 trials", "Q-1000 trials", "Greedy Agent", "Two-Steps Agent"):
        assert text.count(f'<th scope="col">{column}</th>') == 2  # one a robot
    assert ">Left-right, opposite (LeftRight-Origin)</th>" in text
    assert ">At time-out</th>" in text
    assert text.count('<span class="in m"><b>0.50</b>') == 4  # total of greedy and two-step
    assert text.count('<span class="in h"><b>25.0</b>') == 4
    assert text.count('<span class="in r"><b>100\xa0%</b>') >= 4
    assert "</span> 0.25 <" in text  # the paper's after 500 steps
    assert "unfinished" in text


@pytest.mark.parametrize(
    ("experiment", "column", "value", "key"),
    [
        ("table1", "Best known", "0.51", "best known, 50 steps</li>"),
        ("figure4", "Best known", "0.51", "best known</li>"),
        ("sweep", "Of best known", "62\xa0%", "line is the best known"),
    ],
)
def test_the_best_known_distance_is_a_column_or_a_dash_with_its_reason(
    experiment: str, column: str, value: str, key: str
) -> None:
    for simulator, is_known in (("mujoco", True), ("kinematic", False)):
        text = page(small(experiment, simulator=simulator)[0])
        assert text.count(f'<th scope="col">{column}</th>') == 1
        assert "elsewhere a dash stands" in text
        assert (f"<b>{value}</b>" in text) == (key in text) == is_known


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


def test_trials_without_a_result_are_named_on_the_page_and_in_the_csv() -> None:
    tried = config("table1", seeds=3, gaits=(LRO,))
    results = sample_results(tried, lambda _: around(0.3))
    bad, worse = (f"{LRO}/measured/stiff/q-learning/500#{n}" for n in (1, 2))
    results[bad] = TrialResult(failure="=the physics diverged")
    del results[worse]
    summary = summarise(tried, results, {worse: "it killed its worker three times"})
    text = page(summary)
    trial = "Q-learning, 500\u00a0steps, Left-right, opposite, feet measured, stiff robot, seed"
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


def test_a_claim_has_its_verdict_in_every_case_and_its_numbers() -> None:
    summary = summary_of("table1", lambda _: around(0.3), seeds=6)
    text = page(summary)
    assert text.count('class="claims"') == 1
    for claim in summary["claims"]:
        assert f'id="claim-{claim["id"]}"' in text
    assert text.count('<span class="verdict ') == 2 * sum(
        len(claim["where"]) for claim in summary["claims"]
    )
    for told in summary["story"]:
        assert f"<h3>{told['heading'].replace(chr(39), '&#39;')}</h3>" in text


@pytest.fixture
def shown(page: Page) -> Page:
    """A tab that fails its test on any console message, script error or dialog."""
    page.on("console", lambda message: pytest.fail(message.text, pytrace=False))
    page.on("pageerror", lambda error: pytest.fail(str(error), pytrace=False))
    page.on("dialog", lambda dialog: pytest.fail(dialog.message, pytrace=False))
    return page


def _open(tab: Page, folder: Path, summary: Any) -> list[str]:
    """Open a report's page; return the URLs of all requests of the browser."""
    asked: list[str] = []
    tab.on("request", lambda request: asked.append(request.url))
    written = folder / "report.html"
    written.write_text(page(summary))
    tab.goto(written.as_uri())
    return asked


def test_the_page_requests_no_other_resource(shown: Page, tmp_path: Path) -> None:
    asked = _open(shown, tmp_path, small()[0])
    assert asked == [(tmp_path / "report.html").as_uri()]
    policy = shown.locator('meta[http-equiv="Content-Security-Policy"]')
    assert policy.get_attribute("content") == POLICY
    assert shown.locator("script").count() == 0
    assert shown.locator("h1").inner_text() == "Table 1 over many seeds"


def test_the_page_does_not_scroll_horizontally(shown: Page, tmp_path: Path) -> None:
    for experiment in ("table1", "figure4", "sweep"):
        _open(shown, tmp_path, small(experiment)[0])
        for width in (390, 1200):
            shown.set_viewport_size({"width": width, "height": 800})
            assert shown.evaluate("document.documentElement.scrollWidth") == width
            for one in shown.locator(".panel svg").all():
                box = one.bounding_box()
                assert box is not None
                assert box["height"] > 80
                assert box["x"] + box["width"] <= width


def test_units_change_without_a_script(shown: Page, tmp_path: Path) -> None:
    _open(shown, tmp_path, small()[0])
    cell = shown.locator("table.paper td").nth(7)  # greedy's total
    assert cell.inner_text().startswith("0.50")
    shown.get_by_label("half grid sides").check()
    assert cell.inner_text().startswith("25.0")
    shown.get_by_label("of greedy").check()
    assert cell.inner_text().startswith("100\xa0%")


def test_names_are_escaped_on_the_page(shown: Page, tmp_path: Path) -> None:
    summary, _ = small("figure4")
    for part in ("settings", "curves", "pooled"):
        for one in summary[part]:
            one["agent"] = one["agent"].replace("q-learning", NASTY)
            one["gait"] = NASTY
            one["robot"] = NASTY
    summary["trials"]["set_aside"] = [{"key": NASTY, "reason": NASTY}]
    summary["versions"][NASTY] = NASTY
    _open(shown, tmp_path, summary)
    assert shown.locator("img").count() == 0
    assert shown.locator("script").count() == 0
    assert NASTY in shown.locator(".broken").inner_text()


def test_the_page_prints_in_light_colours_in_dark_mode(shown: Page, tmp_path: Path) -> None:
    shown.emulate_media(color_scheme="dark")
    _open(shown, tmp_path, small()[0])
    background = "getComputedStyle(document.body).backgroundColor"
    assert shown.evaluate(background) == "rgb(22, 25, 29)"
    shown.emulate_media(media="print", color_scheme="dark")
    assert shown.evaluate(background) == "rgb(255, 255, 255)"
    assert shown.locator(".units").is_hidden()


def test_an_experiment_without_trials_has_a_page(shown: Page, tmp_path: Path) -> None:
    _open(shown, tmp_path, summarise(config("sweep", seeds=3), {}))
    assert "0 of" in shown.locator(".lead").inner_text()


def _csv(summary: Any, results: Results) -> bytes:
    aside = {one["key"]: one["reason"] for one in summary["trials"]["set_aside"]}
    return trials_csv(from_json(ExperimentConfig, summary["config"]), results, aside)


def _rows(content: bytes) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(content.decode(), newline="")))
