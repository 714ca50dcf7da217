"""Explained steps of trainings and races, and tables of any moment, over REST."""

import re
from typing import Any

import pytest

from app.features.explanations.response_models import ExplanationView, LossView, TableView
from hexapods.agents.explanation import Term, evaluate
from hexapods.domain.records import from_json
from tests.api.calls import Api, refused

STEPS = 100


def stored_values(api: Api, run_id: str) -> dict[tuple[Any, ...], float]:
    """Return the values of the stored table by state and action."""
    table = api.get(f"/trainings/{run_id}/q-table")
    return {(*entry["state"], *entry["action"]): entry["value"] for entry in table["values"]}


def shown_values(table: dict[str, Any]) -> dict[tuple[Any, ...], float]:
    cells = len(table["cells_m"])
    values = {}
    for index, row in enumerate(table["values"], table["first"]):
        state = [index // cells**place % cells for place in (2, 1, 0)]
        for column, value in enumerate(row):
            if value is not None:
                values[*state, *divmod(column, cells)] = value
    return values


def explained(api: Api, run_id: str, **query: int) -> dict[str, Any]:
    answer: dict[str, Any] = api.get(f"/runs/{run_id}/explain", params=query)
    from_json(ExplanationView, answer)
    return answer


def table_at(api: Api, run_id: str, **query: int) -> dict[str, Any]:
    answer: dict[str, Any] = api.get(f"/trainings/{run_id}/table", params=query)
    from_json(TableView, answer)
    return answer


def test_the_newest_table_is_the_stored_one(api: Api, trained: dict[str, Any]) -> None:
    table = table_at(api, trained["id"])

    assert table["step"] == STEPS
    assert (table["states"], table["first"], len(table["values"])) == (125, 0, 125)
    assert shown_values(table) == stored_values(api, trained["id"])
    assert sum(visits or 0 for row in table["visits"] for visits in row) == STEPS


def test_a_learner_over_landings_shows_a_value_for_each(api: Api) -> None:
    training = api.finished(api.train(agent="afterstate-q", steps=30))
    table = table_at(api, training["id"])
    stored = api.get(f"/trainings/{training['id']}/q-table")["values"]
    lines = api.call("GET", f"/trainings/{training['id']}/q-table?format=csv").text.splitlines()

    assert len(table["landings"]["values"]) == len(stored) == len(lines) - 1 == 125
    assert sum(table["landings"]["visits"]) == 30
    assert stored[7]["landing"] == [0, 1, 2]
    assert [landing["value"] for landing in stored] == table["landings"]["values"]
    assert lines[0] == "landing_0,landing_1,landing_2,value,visits"
    update = explained(api, training["id"], step=30)["update"]
    assert [belief["name"] for belief in update["beliefs"]] == ["average reward of a step"]
    assert "R̄" in update["direct"]["rule"]
    assert update["direct"]["is_exact"]


def test_tables_of_earlier_moments_are_those_before(api: Api, trained: dict[str, Any]) -> None:
    rows = [table_at(api, trained["id"], step=step)["visits"] for step in (0, 40, 100, 7)]
    tried = [sum(visits or 0 for row in table for visits in row) for table in rows]

    assert tried == [0, 40, 100, 7]


def test_a_part_of_the_states_can_be_asked_for(api: Api, trained: dict[str, Any]) -> None:
    whole, some_states = (
        table_at(api, trained["id"]),
        table_at(api, trained["id"], first=120, count=9),
    )

    assert some_states["values"] == whole["values"][120:]
    assert some_states["best"] == whole["best"][120:]


def test_every_step_of_a_training_explains_the_stored_value(
    api: Api, trained: dict[str, Any]
) -> None:
    for step in (1, 2, 50, 51, 99, 100, 3):
        explanation = explained(api, trained["id"], step=step)
        update = explanation["update"]["direct"]
        terms = [Term(**term) for term in update["terms"]]
        after = shown_values(table_at(api, trained["id"], step=step))
        before = shown_values(table_at(api, trained["id"], step=step - 1))
        place = (*update["observation"], *update["action"])

        assert update["is_exact"]
        assert evaluate(update["rule"], terms) == update["after"] == after[place]
        assert update["before"] == before[place]
        assert update["action"] == explanation["action"]
        assert {p: v for p, v in after.items() if p != place} == {
            p: v for p, v in before.items() if p != place
        }


def test_a_choice_is_explained_in_sentences(api: Api, trained: dict[str, Any]) -> None:
    explanations = [explained(api, trained["id"], step=step) for step in (1, STEPS)]
    first, last = explanations

    assert first["what"].endswith("it was the first try of this move from there.")
    assert first["why"].startswith("It explored: ")
    assert first["why"].endswith(" moves was taken by lot.")
    assert first["missed"].startswith("It missed ")
    assert explanations[0]["choice"]["draw"] < explanations[0]["choice"]["epsilon"] == 1
    assert last["why"].startswith("It took what it holds for best: ")
    assert explanations[1]["choice"]["epsilon"] == 0
    assert "value in the table" in last["why"]
    assert re.search(r"moves would bring that it has never tried|no move has a", last["missed"])
    assert explanations[1]["update"]["summary"].startswith("It got ")


def test_the_newest_step_is_explained_by_default(api: Api, trained: dict[str, Any]) -> None:
    assert explained(api, trained["id"])["step"] == STEPS


@pytest.mark.parametrize("agent", ["sarsa-lambda", "dyna-q", "r-max", "linear-model"])
def test_steps_of_other_learners_are_explained(api: Api, agent: str) -> None:
    run = api.finished(api.train(agent=agent, steps=30))
    for step in (30, 12, 13):
        explanation = explained(api, run["id"], step=step)
        for sentence in (explanation["what"], explanation["why"], explanation["missed"]):
            assert sentence.endswith(".")
            assert not sentence.endswith("..")
        assert explanation["update"]["summary"]
        assert explanation["update"]["direct"]["is_exact"]
        assert explanation["unexplained"] is None


def test_a_learner_without_a_table_has_none(api: Api) -> None:
    run = api.finished(api.train(agent="linear-model", steps=5))

    refused(api.call("GET", f"/trainings/{run['id']}/table"), 409, "keeps no table")


def test_steps_of_a_continued_training_are_explained(api: Api, trained: dict[str, Any]) -> None:
    run = api.finished(api.train(continue_from=trained["id"], steps=20))
    tables = [
        table_at(api, training["id"], **at) for training, at in ((trained, {}), (run, {"step": 0}))
    ]

    assert tables[0]["values"] == tables[1]["values"]
    assert shown_values(table_at(api, run["id"])) == stored_values(api, run["id"])
    assert explained(api, run["id"], step=11)["update"]["direct"]["is_exact"]


def test_a_training_whose_table_is_gone_cannot_be_explained(api: Api) -> None:
    first = api.finished(api.train(steps=5))
    second = api.finished(api.train(continue_from=first["id"], steps=5))
    api.call("DELETE", f"/trainings/{first['id']}")

    for path in (f"/runs/{second['id']}/explain", f"/trainings/{second['id']}/table"):
        refused(api.call("GET", path), 409, "cannot be built again", f"no training '{first['id']}'")


def test_a_training_is_explained_while_it_runs_and_is_changed(api: Api) -> None:
    run = api.slow_training()
    seen = explained(api, run["id"], step=1)
    api.call("PATCH", f"/trainings/{run['id']}", json={"settings": {"alpha": 0.5, "epsilon": 0.1}})
    now = api.until(run, lambda now: now["changes"] and now["progress"]["done"] > 40)
    at = now["changes"][0]["step"]
    before, after = (explained(api, run["id"], step=step) for step in (at, at + 1))
    rates = [
        next(
            term["value"]
            for term in explanation["update"]["direct"]["terms"]
            if term["symbol"] == "α"
        )
        for explanation in (before, after)
    ]
    assert rates == [0.3, 0.5]
    assert after["choice"]["epsilon"] == 0.1
    api.tell(run, "stop")
    api.ended(run)

    assert explained(api, run["id"], step=1) == seen
    assert shown_values(table_at(api, run["id"])) == stored_values(api, run["id"])


def test_lanes_of_a_race_are_explained(api: Api, trained: dict[str, Any]) -> None:
    lanes = [
        {"agent": "q-learning", "training_id": trained["id"]},
        {"agent": "sarsa", "keep_learning": True},
        {"agent": "greedy"},
    ]
    race = api.finished(api.race(steps=10, lanes=lanes))
    frozen, learning, search = (explained(api, race["id"], lane=n, step=6) for n in range(3))

    assert frozen["choice"]["kind"] == "exploited"
    assert frozen["update"] is None
    assert learning["update"]["direct"]["is_exact"]
    assert explained(api, race["id"], lane=1, step=10)["update"] is None
    assert search["choice"] is search["unexplained"] is None
    assert search["search"]["transitions"] == len(search["search"]["futures"]) == 12
    best = search["search"]["futures"][0]
    assert best["action"] == search["action"]
    assert best["reward_m"] == best["return_m"] == search["reward_m"]
    assert search["why"].startswith("It simulated 12 steps and compared the ")
    assert "this move came first with" in search["why"]
    assert search["missed"].endswith("; what came is what it foresaw.")


def test_steps_and_lanes_that_are_not_there_are_refused(api: Api, trained: dict[str, Any]) -> None:
    path = f"/runs/{trained['id']}/explain"
    table = f"/trainings/{trained['id']}/table"
    for query, sentence in (
        ("?step=0", "Step must be from 1 to 100, not 0."),
        ("?step=101", "Step must be from 1 to 100, not 101."),
        ("?step=-5", "Step must be from 1 to 100, not -5."),
        ("?lane=1", "A training has one lane, 0."),
    ):
        refused(api.call("GET", path + query), 422, sentence)
    refused(api.call("GET", f"{path}?step=soon"), 422, "step must be a whole number, the steps")
    refused(api.call("GET", f"{path}?lane=x"), 422, "lane must be a whole number, the number of a")
    refused(api.call("GET", f"{table}?count=0"), 422, "count must be a whole number, 1 or more")
    refused(api.call("GET", f"{table}?first=-1"), 422, "first must be a whole number, the index")
    refused(api.call("GET", f"{table}?step=101"), 422, "Step must be from 0 to 100, not 101.")
    refused(api.call("GET", f"{table}?first=125"), 422, "First must be from 0 to 124, not 125.")
    refused(api.call("GET", "/runs/0000000000000/explain"), 404, "")
    refused(api.call("GET", "/trainings/0000000000000/table"), 404, "")


def test_a_training_without_a_log_says_so(api: Api, trained: dict[str, Any]) -> None:
    file = api.call("GET", f"/trainings/{trained['id']}/q-table?format=npz").content
    run = api.call("POST", "/trainings/import", content=file).json()

    refused(api.call("GET", f"/runs/{run['id']}/explain"), 409, "has no log of its steps")


def test_the_loss_of_a_learner_is_explained(api: Api, trained: dict[str, Any]) -> None:
    lanes = [{"agent": "q-learning", "training_id": trained["id"]}, {"agent": "greedy"}]
    race = api.finished(api.race(lanes=[*lanes, {"agent": "linear-model"}]))
    loss = api.get(f"/races/{race['id']}/loss", params={"lane": 0})
    from_json(LossView, loss)
    total_m = [lane["total_distance_m"] for lane in race["result"]["lanes"]]

    assert (loss["steps"], loss["practised_steps"], loss["entries"]) == (50, STEPS, 1500)
    assert 0 < loss["tried"] <= STEPS
    assert loss["is_ranked"]
    assert loss["behind_m"] > 0
    assert loss["reward_m"] * 50 == pytest.approx(total_m[0])
    assert loss["best_reward_m"] > loss["reward_m"]
    assert loss["better"] == loss["untried"] + loss["undervalued"] + loss["not_chosen"] > 0
    assert f"tried {loss['tried']} of the 1500 moves" in loss["sentences"][0]

    path = f"/races/{race['id']}/loss?lane="
    refused(api.call("GET", f"{path}2&clock=free"), 409, "keeps no table")
    refused(api.call("GET", f"{path}1&clock=free"), 409, "Lane 1, greedy, is not behind")
    refused(api.call("GET", f"{path}3"), 422, "Lane must be from 0 to 2, not 3.")
    refused(api.call("GET", f"/races/{trained['id']}/loss?lane=0"), 404, "")
    assert api.get(f"/races/{race['id']}/loss", params={"lane": 0}) == loss


def test_the_loss_of_a_learner_that_practises_in_the_race_is_explained(api: Api) -> None:
    lanes = [{"agent": "sarsa", "keep_learning": True}, {"agent": "greedy"}]
    race = api.finished(api.race(steps=20, lanes=lanes))
    loss = api.get(f"/races/{race['id']}/loss", params={"lane": 0, "clock": "free"})

    assert (loss["practised_steps"], loss["steps"]) == (0, 20)
    assert 0 < loss["tried"] < 20
    assert loss["sentences"][0].startswith("Before its last step it had tried")
