"""What is answered about experiments is as its models describe it."""

import pytest

from app.features.experiments.response_models import (
    ExperimentPage,
    ExperimentView,
    SummaryView,
    TrialsView,
)
from tests.api.calls import Api
from tests.experiments.sample_experiments import around, summary_of, walked


def test_real_responses_match_their_models(api: Api) -> None:
    body = {"experiment": "sweep", "seeds": 2, "steps": 20, "gaits": "left-right-origin"}
    experiment = api.start("/experiments", {**body, "simulator": "kinematic", "workers": 1})
    address = f"/experiments/{experiment['id']}"
    ExperimentView.model_validate(experiment)
    SummaryView.model_validate(api.get(f"{address}/summary"))
    ExperimentView.model_validate(api.finished(experiment))
    SummaryView.model_validate(api.get(f"{address}/summary"))
    TrialsView.model_validate(api.get(f"{address}/trials"))
    assert ExperimentPage.model_validate(api.get("/experiments")).items


@pytest.mark.parametrize("experiment", ["table1", "figure4", "sweep"])
def test_summaries_of_every_experiment_match_the_model(experiment: str) -> None:
    agents = {} if experiment == "table1" else {"agents": ("q-learning", "greedy")}
    if experiment == "figure4":
        agents = {}
    for seeds in (1, 10):
        summary = summary_of(experiment, lambda setting: around(0.4), seeds=seeds, **agents)
        SummaryView.model_validate(summary)
        assert summary["settings"]


def test_summary_of_a_run_experiment_matches_the_model() -> None:
    from hexapods.experiments.summary import summarise

    tried, results = walked("table1", 2, gaits=("left-right-origin",))
    SummaryView.model_validate(summarise(tried, results, {"key#0": "it died"}))
