"""Another learner than the default one: its settings, its training, its race and its sweep."""

import re
from typing import Any
from urllib.parse import urlencode

import pytest
from playwright.sync_api import Locator, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving

pytestmark = pytest.mark.timeout(300)

SHORT = urlencode(
    {"steps": 6, "evaluate_every": 0, "race_steps": 3, "simulator": "kinematic", "alpha": 0.5}
)
LONG = urlencode({"steps": 100_000, "pace": 8})
SMALL_SWEEP = urlencode(
    {
        "experiment": "sweep",
        "simulator": "kinematic",
        "gaits": "left-right-origin",
        "seeds": 2,
        "steps": 50,
    }
)


def learner(dashboard: Dashboard) -> Locator:
    return dashboard.page.get_by_label("Learner", exact=True)


def trace_decay(dashboard: Dashboard) -> Locator:
    return dashboard.page.get_by_role("slider", name="Trace decay λ")


def trainings(dashboard: Dashboard) -> list[dict[str, Any]]:
    """Return the trainings of the server, the newest first."""
    items: list[dict[str, Any]] = dashboard.get("/api/v1/trainings")["items"]
    return items


def changed(dashboard: Dashboard) -> dict[str, Any]:
    """Return the values to which the settings of the only training were changed last."""
    [training] = trainings(dashboard)
    settings = [change.get("settings", {}) for change in training["changes"]]
    return {name: value for setting in settings for name, value in setting.items()}


def test_settings_of_the_learner_act_on_its_training(dashboard: Dashboard, server: Serving) -> None:
    page = dashboard.page
    dashboard.open(f"{server.address}?{LONG}&depth=try&tab=train")
    expect(trace_decay(dashboard)).to_have_count(0)
    learner(dashboard).select_option("Sarsa(λ)")
    expect(trace_decay(dashboard)).to_have_value("0.9")
    dashboard.open_tab("Board")
    expect(dashboard.start_list.first).to_contain_text("Sarsa(λ)")
    dashboard.open_tab("Train")
    trace_decay(dashboard).fill("0.5")
    expect(page).to_have_url(re.compile(r"agent=sarsa-lambda.*trace_decay=0\.5"))

    dashboard.button("Train, don’t race").click()
    expect(page.get_by_role("slider", name="Exploration now ε")).to_be_visible()
    [training] = trainings(dashboard)
    assert training["config"]["agent"] == "sarsa-lambda"
    assert training["config"]["settings"]["trace_decay"] == 0.5
    trace_decay(dashboard).fill("0.25")
    dashboard.eventually(lambda: changed(dashboard).get("trace_decay") == 0.25, "the new λ")
    page.get_by_role("slider", name="Exploration now ε").fill("0.4")
    dashboard.eventually(lambda: changed(dashboard).get("epsilon") == 0.4, "the new ε")

    learner(dashboard).select_option("Q-learning")
    # The training that runs still has it, the form's learner does not.
    trace_decay(dashboard).fill("0.75")
    dashboard.eventually(lambda: changed(dashboard).get("trace_decay") == 0.75, "the newer λ")
    dashboard.button("Stop").click()
    expect(trace_decay(dashboard)).to_have_count(0)

    page.get_by_role("link", name="Runs").click()
    expect(dashboard.runs).to_contain_text("Sarsa(λ)")
    expect(dashboard.runs).to_contain_text(re.compile(r"λ\s0\.75 from step \d+"))
    page.get_by_label("More for this training").click()
    page.get_by_role("link", name="Use its settings").click()
    page.get_by_role("link", name="Race", exact=True).click()
    expect(learner(dashboard)).to_have_value("sarsa-lambda")
    # As it was at the end, not as it began.
    expect(trace_decay(dashboard)).to_have_value("0.75")


def test_each_learner_of_a_race_has_its_own_settings(dashboard: Dashboard, server: Serving) -> None:
    page = dashboard.page
    dashboard.open(f"{server.address}?{SHORT}&depth=study&tab=train")
    dashboard.unfold("Race")
    page.get_by_role("checkbox", name="Two-step", exact=True).uncheck()
    learner(dashboard).select_option("Sarsa(λ)")
    expect(page.get_by_role("checkbox", name="Sarsa(λ)", exact=True)).to_be_checked()
    expect(page.get_by_role("checkbox", name="Q-learning", exact=True)).not_to_be_checked()
    page.get_by_role("checkbox", name="Q-learning", exact=True).check()
    page.get_by_role("checkbox", name="Sarsa(λ)", exact=True).uncheck()
    note = dashboard.actions.get_by_text(re.compile(r"Sarsa\(λ\) is not in the race"))
    expect(note).to_contain_text("Q-learning")
    assert dashboard.violations() == []
    dashboard.button("Add Sarsa(λ)").click()
    expect(note).to_have_count(0)
    expect(page.get_by_role("checkbox", name="Sarsa(λ)", exact=True)).to_be_checked()

    dashboard.primary.click()
    dashboard.open_tab("Board")
    dashboard.eventually(dashboard.has_figures, "the scoreboard fills")
    configs = {training["config"]["agent"]: training["config"] for training in trainings(dashboard)}
    assert set(configs) == {"q-learning", "sarsa-lambda"}
    assert [config["settings"]["alpha"] for config in configs.values()] == [0.5, 0.5]
    assert configs["sarsa-lambda"]["settings"]["trace_decay"] == 0.9
    assert "trace_decay" not in configs["q-learning"]["settings"]

    expect(dashboard.primary).to_have_text("Practise 6 more, race again")
    dashboard.primary.click()
    dashboard.eventually(lambda: len(trainings(dashboard)) == 4, "the trainings that continue")
    first, second, *before = trainings(dashboard)
    continued = {
        training["config"]["agent"]: training["config"]["continue_from"]
        for training in (first, second)
    }
    assert continued == {training["config"]["agent"]: training["id"] for training in before}


def test_a_sweep_varies_the_settings_of_its_agents(dashboard: Dashboard, server: Serving) -> None:
    page = dashboard.page
    page.goto(f"{server.address}#experiments?{SMALL_SWEEP}")
    dashboard.button("All settings").click()
    decays = page.get_by_label("λ", exact=True)
    expect(page.get_by_label("α", exact=True)).to_be_visible()
    expect(decays).to_have_count(0)
    page.get_by_role("checkbox", name="Sarsa(λ)", exact=True).check()
    expect(decays).to_have_value("0.9")
    decays.fill("0.5, 2")
    expect(page.get_by_role("alert").filter(has_text="from 0 to 1")).to_be_visible()
    decays.fill("0.5, 0.9")
    dashboard.button("Run Sweep: 7 trials").click()
    expect(dashboard.experiment_state("finished")).to_be_visible()

    [run] = dashboard.get("/api/v1/experiments")["items"]
    assert run["config"]["settings"]["trace_decay"] == [0.5, 0.9]
    assert run["progress"] == {"done": 7, "total": 7}
    table = page.get_by_role("table").filter(has_text="Total distance")
    expect(table.get_by_role("columnheader", name="Agent, λ", exact=True)).to_be_visible()
    expect(table.get_by_role("row", name=re.compile(r"^Q-learning \d"))).to_have_count(1)
    expect(table.get_by_role("row", name=re.compile(r"^Sarsa\(λ\), λ\s0\.[59]"))).to_have_count(2)
    assert dashboard.violations() == []
    dashboard.button("New experiment").click()
    page.get_by_role("checkbox", name="Sarsa(λ)", exact=True).uncheck()
    expect(decays).to_have_count(0)
    expect(dashboard.button("Run Sweep: 3 trials")).to_be_visible()
