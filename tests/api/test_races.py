"""The resource `races`: start with trainings, result, recording, timeline; and the stage."""

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import hexapods as hx
from hexapods.agents import registry
from hexapods.runs.race_file import race_recording
from tests.api.calls import WALK, Api, refused
from tests.cli.running import in_process, output

PRACTICE = {"steps": 100}
LANES = [
    {"agent": "q-learning", "training": PRACTICE},
    {"agent": "greedy"},
    {"agent": "two-step"},
]


@pytest.fixture(scope="module")
def raced(api: Api) -> dict[str, Any]:
    """Return a finished race of the paper's three lanes, after a short practice."""
    return api.finished(api.race(lanes=LANES, name="raced once"))


def test_race_needs_only_a_gait(api: Api) -> None:
    race = api.start("/races", {"gait": WALK["gait"]})
    lanes = race["config"]["lanes"]
    assert [lane["agent"] for lane in lanes] == ["q-learning", "greedy", "two-step"]
    assert race["waiting_for"] == [lanes[0]["training_id"]]
    training = api.get(f"/trainings/{lanes[0]['training_id']}")
    assert training["config"]["steps"] == 500
    assert race["config"]["steps"] == 50
    assert race["state"] == "queued"
    api.stop(race)


def test_race_trains_its_learner_first(raced: dict[str, Any], api: Api) -> None:
    lanes = raced["result"]["lanes"]
    training = api.get(f"/trainings/{lanes[0]['training_id']}")
    assert training["state"] == "finished"
    assert training["ended_at"] <= raced["started_at"]
    assert raced["waiting_for"] == []
    assert [lane["simulated_transitions"] for lane in lanes] == [0, 600, 7800]
    assert [lane["steps"] for lane in lanes] == [50, 50, 50]
    assert lanes[0]["total_distance_m"] == pytest.approx(training["result"]["distance_m"], abs=0.5)
    assert lanes[1]["total_distance_m"] == pytest.approx(24.833 * 0.02, abs=1e-5)
    for lane in lanes:
        assert set(lane["clocks"]) == {"paper", "wall", "free"}
        for under in lane["clocks"].values():
            assert {"finished_distance_m", "elapsed_s", "rank"} <= set(under)
    assert isinstance(raced["result"]["shared_machine"], bool)


def test_race_is_reproducible(raced: dict[str, Any], api: Api) -> None:
    again = api.finished(api.race(lanes=LANES))
    for lane, same_lane in zip(raced["result"]["lanes"], again["result"]["lanes"], strict=True):
        for name in ("total_distance_m", "simulated_transitions", "steps"):
            assert lane[name] == same_lane[name]
        for clock in ("paper", "free"):
            assert lane["clocks"][clock] == same_lane["clocks"][clock]


def test_a_race_has_one_hash_over_rest_in_the_library_and_on_the_command_line(
    api: Api, tmp_path: Path
) -> None:
    lanes = [{"agent": "q-learning", "training": PRACTICE}, {"agent": "greedy"}]
    raced = api.finished(api.race(lanes=lanes, steps=30, seed=4))

    walk_fields: dict[str, Any] = WALK
    race = hx.race(
        [hx.train(**walk_fields, steps=100, seed=4), "greedy"], **walk_fields, steps=30, seed=4
    )
    walk = [word for name, value in WALK.items() for word in (f"--{name}", value)]
    output("train", *walk, "--steps", "100", "--seed", "4", "--out", "q.npz", folder=tmp_path)
    options = ("--lane", "q-learning=q.npz", "--lane", "greedy", "--steps", "30", "--seed", "4")
    printed = output("race", *walk, *options, folder=tmp_path, run=in_process)

    sha256 = raced["result"]["recording_sha256"]
    assert sha256 == race.recording_sha256 == printed["recording_sha256"]
    other = api.finished(api.race(lanes=lanes, steps=30, seed=5))
    assert other["result"]["recording_sha256"] != sha256


def test_lane_can_use_an_existing_table(api: Api, trained: dict[str, Any]) -> None:
    lanes = [{"agent": "q-learning", "training_id": trained["id"]}]
    robot = {"preset": "compliant"}
    race = api.finished(api.race(lanes=lanes, robot="compliant"))
    assert race["waiting_for"] == []
    assert race["config"]["robot"] == robot
    lane = race["result"]["lanes"][0]
    assert lane["training_id"] == trained["id"]
    assert lane["trained_robot"] == trained["config"]["robot"]
    plain = api.finished(api.race(lanes=lanes))["result"]["lanes"][0]
    assert plain["trained_robot"] is None


def test_lane_uses_the_observation_of_its_table(api: Api) -> None:
    practice = {"steps": 20, "observation": "commanded", "seed": 3}
    race = api.finished(api.race(lanes=[{"agent": "q-learning", "training": practice}], seed=9))
    lane = race["config"]["lanes"][0]
    assert lane["observation"] == "commanded"
    training = api.get(f"/trainings/{lane['training_id']}")
    assert (training["config"]["seed"], race["config"]["seed"]) == (3, 9)


def test_lane_has_settings_of_its_own(api: Api) -> None:
    lanes = [{"agent": "look-ahead", "settings": {"depth": depth}} for depth in (1, 2)]
    race = api.finished(api.race(lanes=lanes, steps=3))
    assert [lane["settings"]["depth"] for lane in race["config"]["lanes"]] == [1, 2]
    transitions = [lane["simulated_transitions"] for lane in race["result"]["lanes"]]
    assert transitions == [3 * 12, 3 * 156]


def test_lane_has_an_observation_of_its_own(api: Api) -> None:
    learner = {"agent": "q-learning", "keep_learning": True, "observation": "planned"}
    practice = {**PRACTICE, "observation": "commanded"}
    practised = {"agent": "q-learning", "training": practice, "observation": "commanded"}
    race = api.race(lanes=[learner, {"agent": "greedy"}, practised], steps=3)
    api.stop(race)
    seen = [lane["observation"] for lane in race["config"]["lanes"]]
    assert seen == ["planned", "measured", "commanded"]


def test_lane_may_learn_in_the_race_without_practice(api: Api) -> None:
    lane = {"agent": "q-learning", "keep_learning": True, "settings": {"epsilon_start": 0.1}}
    race = api.finished(api.race(lanes=[lane], steps=10))
    assert race["waiting_for"] == []
    (shown,) = race["config"]["lanes"]
    assert (shown["training_id"], shown["keep_learning"]) == (None, True)
    assert (shown["settings"]["alpha"], shown["settings"]["epsilon_start"]) == (0.3, 0.1)


@pytest.mark.parametrize(
    ("lane", "names"),
    [
        (
            {"agent": "look-ahead", "settings": {"depth": 0}},
            "lanes.0.settings.depth must be",
        ),
        ({"agent": "look-ahead", "settings": {"depth": 5}}, "Lane 1: depth 5 would simulate more"),
        *(
            ({"agent": agent, "settings": {"budget": 0}}, "lanes.0.settings.budget must be a whole")
            for agent in ("informed", "mcts")
        ),
        ({"agent": "look-ahead", "settings": {"width": 5}}, "unknown field 'width'"),
        ({"agent": "greedy", "keep_learning": True}, "Lane 1: greedy does not learn, so it cannot"),
        ({"agent": "greedy", "keep_learning": 1}, "keep_learning must be true or false"),
        (
            {"agent": "greedy", "observation": "guessed"},
            "observation must be measured, or commanded, or planned",
        ),
        (
            {"agent": "q-learning", "training": {}, "observation": "planned"},
            "Lane 1: observation must be measured, in which its training was learned, not planned",
        ),
        ({"agent": "q-learning"}, "Lane 1: q-learning races with what it has learned"),
        (
            {"agent": "q-learning", "training": {}, "settings": {"alpha": 0.5}},
            "Lane 1: a lane with training takes its settings from there; leave out alpha",
        ),
    ],
)
def test_lane_with_wrong_settings_is_refused_in_one_sentence(
    api: Api, lane: dict[str, Any], names: str
) -> None:
    refused(api.call("POST", "/races", json={**WALK, "lanes": [lane]}), 422, names)


def test_race_can_continue_an_earlier_training(api: Api, raced: dict[str, Any]) -> None:
    before = raced["config"]["lanes"][0]["training_id"]
    practice = {**PRACTICE, "continue_from": before}
    again = api.finished(api.race(lanes=[{"agent": "q-learning", "training": practice}]))
    training = api.get(f"/trainings/{again['config']['lanes'][0]['training_id']}")
    assert training["config"]["continue_from"] == before


def test_stopping_a_race_stops_its_training(api: Api) -> None:
    practice = {"steps": 10_000_000, "pace": 1, "evaluate_every": 0}
    race = api.race(lanes=[{"agent": "q-learning", "training": practice}])
    training = api.get(f"/trainings/{race['waiting_for'][0]}")
    api.until(training, lambda now: now["state"] == "running")
    assert api.tell(race, "stop").json()["state"] == "stopped"
    assert api.ended(training)["state"] == "stopped"


def test_stopping_a_training_stops_the_race_with_the_reason(api: Api) -> None:
    practice = {"steps": 10_000_000, "pace": 1, "evaluate_every": 0}
    race = api.race(lanes=[{"agent": "q-learning", "training": practice}])
    training = api.get(f"/trainings/{race['waiting_for'][0]}")
    refused(api.tell(race, "pause"), 409, "queued")
    api.until(training, lambda now: now["progress"]["done"] > 0)
    api.stop(training)
    now = api.ended(race)
    assert now["state"] == "stopped"
    assert training["id"] in now["error"]
    refused(api.call("GET", f"/races/{race['id']}/recording"), 409, "no recording")


def test_training_that_a_queued_race_needs_cannot_be_deleted(
    api: Api, trained: dict[str, Any]
) -> None:
    practice = {"steps": 10_000_000, "pace": 1, "evaluate_every": 0}
    lanes = [
        {"agent": "q-learning", "training_id": trained["id"]},
        {"agent": "q-learning", "training": practice},
    ]
    race = api.race(lanes=lanes)
    refused(api.call("DELETE", f"/trainings/{trained['id']}"), 409, race["id"])
    api.stop(race)


def test_recording_matches_its_arrays(api: Api, raced: dict[str, Any]) -> None:
    path = f"/races/{raced['id']}/recording"
    shown = api.get(path)
    assert [lane["agent"] for lane in shown["lanes"]] == ["q-learning", "greedy", "two-step"]
    data = api.call("GET", f"{path}?format=npz")
    assert len(data.content) < 400_000
    with np.load(io.BytesIO(data.content), allow_pickle=False) as file:
        lanes = race_recording(dict(file))
    for lane, shown_lane in zip(lanes, shown["lanes"], strict=True):
        assert [step.distance_m for step in lane.steps] == [
            s["distance_m"] for s in shown_lane["steps"]
        ]
        last = shown_lane["steps"][-1]
        assert np.allclose(lane.steps[-1].motion.qpos, last["qpos"], atol=1e-5)
        assert len(last["time_s"]) == len(last["qpos"])


def test_its_timeline_is_flat_while_it_thinks(api: Api, raced: dict[str, Any]) -> None:
    shown = api.get(f"/races/{raced['id']}/timeline")
    assert (shown["clock"], shown["steps"], shown["finish_line_m"]) == ("paper", 50, 0.45)
    learner, greedy, two_step = shown["lanes"]
    assert learner["color"] == "#E69F00"
    assert learner["thinking"] == []
    assert learner["total_s"] == pytest.approx(16, abs=0.1)
    assert shown["first_finish_s"] == learner["total_s"]
    assert greedy["futures"] == [12] * 50
    assert two_step["total_s"] == pytest.approx(91, abs=0.5)
    assert greedy["crossed_s"] < two_step["crossed_s"]
    assert len(greedy["points"]) == 101
    began, ended = greedy["thinking"][1]
    distances = dict(map(tuple, greedy["points"]))
    assert distances[began] == distances[ended]
    free = api.get(f"/races/{raced['id']}/timeline?clock=free")
    assert {lane["total_s"] for lane in free["lanes"]} == {learner["total_s"]}
    refused(api.call("GET", f"/races/{raced['id']}/timeline?clock=sun"), 422, "paper, wall, free")


def test_new_run_takes_a_stage_without_live_run(api: Api) -> None:
    first = api.slow_training()
    api.call("PUT", "/stage", json={"run_id": first["id"]})
    second = api.slow_training()
    assert api.get("/stage")["run_id"] == first["id"], "a live run holds it"
    api.stop(first)
    third = api.slow_training()
    assert api.get("/stage")["run_id"] == third["id"]
    shown = api.call("PUT", "/stage", json={"run_id": second["id"], "speed": 4}).json()
    assert (shown["run_id"], shown["speed"]) == (second["id"], 4)
    api.stop(second, third)


def test_full_queue_refuses_starts_with_retry_after(serve: Callable[..., Api]) -> None:
    api = serve()  # whose jobs never start, so that all of them wait
    lanes = [{"agent": "q-learning", "training": {}}] * 6
    answers = [api.call("POST", "/races", json={**WALK, "lanes": lanes}) for _ in range(50)]
    taken = [answer for answer in answers if answer.status_code == 202]
    assert 4 <= len(taken) < 50
    refused(answers[-1], 429, "32")
    assert int(answers[-1].headers["retry-after"]) > 0
    assert api.get("/trainings?limit=100")["items"], "all or none of a race is taken"
    assert len(api.get("/trainings?limit=100")["items"]) == 6 * len(taken)


def test_all_options_can_be_started(api: Api) -> None:
    options = api.get("/options")
    walks = [("stiff", gait["name"]) for gait in options["gaits"]]
    # Not every gait makes sense for every robot; its own does.
    walks += [(robot["name"], robot["gait"]) for robot in options["robots"]]
    for robot, gait in walks:
        body = {**WALK, "gait": gait, "robot": robot, "steps": 1}
        api.stop(api.start("/trainings", body))
    learns = {agent["name"]: agent["learns"] for agent in options["agents"]}
    assert learns == {name: registry.learns(name) for name in registry.BUILT_IN}
    api.stop(api.start("/trainings", options["defaults"]["training"]))
    assert set(options["limits"]) <= set(options["help"])


def test_another_format_of_a_recording_is_refused_with_those_that_there_are(
    raced: dict[str, Any], api: Api
) -> None:
    path = f"/races/{raced['id']}/recording"
    refused(api.call("GET", path, params={"format": "viser"}), 422, "format must be json or npz.")


def test_race_is_replayed_by_each_page_for_itself(raced: dict[str, Any], api: Api) -> None:
    ghost = api.finished(api.race(lanes=[{"agent": "greedy"}], steps=5))["id"]
    shared = ("run_id", "speed", "clock", "playing")
    before = {name: api.get("/stage")[name] for name in shared}
    path = f"/runs/{raced['id']}/replay"
    plan = api.get(path, params={"clock": "free"})
    lanes = raced["result"]["lanes"]

    assert plan["clock"] == "free"
    assert plan["complete"]
    assert plan["recorded_s"] == [[0.0, plan["duration_s"]]]
    assert plan["duration_s"] == max(lane["clocks"]["free"]["elapsed_s"] for lane in lanes)
    assert [len(ends) for ends in plan["step_ends_s"]] == [50, 50, 50]
    assert "time-out" in {mark["kind"] for mark in plan["marks"]}
    for address in ("/scene", "/moment?time_s=1.5", "/segments/0/1?clock=free"):
        packed = api.call("GET", path + address)
        plain = api.call("GET", path + address, headers={"Accept-Encoding": "identity"})
        assert packed.headers["content-encoding"] == "gzip"
        assert packed.content == plain.content, "the client unpacks it"
    assert api.get(path, params={"ghost": ghost})["ghost_id"] == ghost
    for address in ("/scene?ghost=", "/moment?time_s=1.5&ghost=", "/segments/0/1?ghost="):
        packed = api.call("GET", path + address + ghost)
        assert packed.content != api.call("GET", path + address.split("ghost")[0]).content
    after = api.get("/stage")
    assert {name: after[name] for name in shared} == before, "the stage is everybody's"


def test_replay_that_cannot_be_says_why(
    raced: dict[str, Any], trained: dict[str, Any], api: Api
) -> None:
    path = f"/runs/{raced['id']}/replay"
    refused(api.call("GET", "/runs/none/replay"), 404, "none")
    refused(api.call("GET", f"{path}/segments/0/100000"), 404, "its last segment is")
    refused(api.call("GET", f"{path}/segments/8/0"), 422, "level must be a whole number from -3")
    refused(api.call("GET", f"{path}/segments/0/-1"), 422, "number must be a whole number, 0")
    refused(api.call("GET", f"{path}/moment?time_s=-1"), 422, "0 or more")
    refused(api.call("GET", f"{path}?clock=sundial"), 422, "paper, wall, free")
    refused(api.call("GET", f"{path}?ghost=gone"), 404, "gone")
    refused(api.call("GET", f"{path}/scene?ghost={trained['id']}"), 422, "choose another race")
    past = api.call("GET", f"{path}/moment?time_s=1e6")
    assert past.status_code == 200, "the last moment"
    posture = f"{path}/posture?cells="
    assert api.call("GET", f"{posture}1,2,3&lane=2&time_s=1.5").status_code == 200
    refused(api.call("GET", f"{posture}1,2"), 422, "3 numbers, one for each group of legs, not 2")
    refused(api.call("GET", f"{posture}1,2,5"), 422, "from 0 to 4, not 5")
    refused(api.call("GET", f"{posture}1,,2"), 422, "cells must be a cell of the foot grid for")
    refused(api.call("GET", f"{path}/posture"), 422, "cells is missing; it must be")
    refused(api.call("GET", f"{posture}1,2,3&lane=3"), 422, "Lane must be from 0 to 2, not 3")
    refused(api.call("GET", f"{posture}1,2,3&time_s=nan"), 422, "time_s must be a number")
    queued = api.race(lanes=[{"agent": "q-learning", "training": {"steps": 100_000}}])
    assert api.get(f"/runs/{queued['id']}/replay")["recorded_s"] == []
    refused(api.call("GET", f"/runs/{queued['id']}/replay/segments/0/0"), 404, "is recorded yet")
    api.stop(queued)
    refused(api.call("GET", f"/runs/{queued['id']}/replay"), 409, "has no recording")
    assert api.call("GET", f"/runs/{queued['id']}/replay/scene").status_code == 200
