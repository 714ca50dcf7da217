"""Disturbances over REST: worlds of trainings and races, changes while they run, and branches."""

from typing import Any

import pytest

from hexapods.assembly import build_walkers
from hexapods.domain.world import named_world, world
from hexapods.runs.best_known import best_known_m
from hexapods.runs.config import WalkingProblem
from hexapods.runs.lane import lane_config
from hexapods.runs.race_config import Branch, RaceConfig
from hexapods.runs.racing import record_race
from tests.api.calls import WALK, Api, refused
from tests.features.needing import needs
from tests.quick_robot import HASTY

MUJOCO = {"gait": WALK["gait"]}
LIMP = {"kind": "limp", "legs": [1, 4]}
GREEDY = {"agent": "greedy"}


def test_a_training_takes_a_world_and_what_happens_later(api: Api) -> None:
    body = {**MUJOCO, "world": "slope", "disturbances": [{**LIMP, "at_step": 25}], "steps": 40}
    run = api.start("/trainings", body)
    api.stop(run)

    slope = {"kind": "slope", "at_step": 0, "degrees": 8.0, "direction_deg": 0.0}
    limp = {"kind": "limp", "at_step": 25, "legs": [1, 4]}
    assert run["config"]["disturbances"] == [slope, limp]


def test_practice_for_a_race_is_in_the_world_of_its_start(api: Api) -> None:
    lanes = [{"agent": "q-learning", "training": {"steps": 20}}]
    slope = {"kind": "slope", "degrees": 5}
    body = {**MUJOCO, "lanes": lanes, "disturbances": [slope, {**LIMP, "at_step": 9}], "steps": 10}
    race = api.start("/races", body)
    training = api.get(f"/trainings/{race['waiting_for'][0]}")
    api.stop(training, race)

    assert [disturbance["kind"] for disturbance in race["config"]["disturbances"]] == [
        "slope",
        "limp",
    ]
    assert [disturbance["kind"] for disturbance in training["config"]["disturbances"]] == ["slope"]


def disturb(api: Api, run: dict[str, Any], body: Any) -> Any:
    return api.call("POST", f"/trainings/{run['id']}/disturbances", json=body)


def test_something_happens_while_a_training_runs(api: Api) -> None:
    run = api.slow_training(name="noisy")
    response = disturb(api, run, {"kind": "sensor-noise", "sd_m": 0.004})
    assert response.status_code == 202, response.text
    disturbance = response.json()
    now = api.look(run)
    assert disturbance == {"kind": "sensor-noise", "at_step": disturbance["at_step"], "sd_m": 0.004}
    assert disturbance["at_step"] > 0
    # The feet were measured already before the next step.
    assert now["changes"] == [{"step": disturbance["at_step"] - 1, "disturbance": disturbance}]

    paused = api.tell(run, "pause").json()
    for sd_m in (0.01, 0.0):  # the second replaces the first, which began in the same step
        assert disturb(api, run, {"kind": "sensor-noise", "sd_m": sd_m}).status_code == 202
    steps = [change["step"] for change in api.look(run)["changes"]]
    assert steps[1] == steps[2] >= steps[0]
    assert paused["state"] == "paused"
    api.stop(run)
    refused(disturb(api, run, {"kind": "sensor-noise", "sd_m": 0.01}), 409, "stopped")


def test_what_cannot_happen_to_a_running_training_changes_nothing(api: Api) -> None:
    noise = {"kind": "sensor-noise", "sd_m": 0.01}
    run = api.slow_training(name="undisturbed")
    for body, words in (
        ({"kind": "slope", "degrees": 8}, "knows no slope, only sensor-noise"),
        ({**noise, "sd_m": -1}, "from 0 to 0.05 m"),
        ({**noise, "at_step": 5}, "leave out at_step"),
        ({**noise, "until_step": 1}, "until_step must be over"),
        ({**noise, "until_step": 10_000_000_000}, "until_step must be a whole number from 1"),
        ({"kind": "limp", "legs": [9]}, "there is no leg 9"),
        ({"kind": "fire"}, "choose one of: limp, stuck"),
        ({"legs": [1]}, "kind"),
    ):
        refused(disturb(api, run, body), 422, words)
    assert api.look(run)["changes"] == []
    api.stop(run)


@needs("what_if")
def test_an_end_after_the_run_is_refused_wherever_one_is_asked_for(api: Api) -> None:
    """In stored runs it means the same as no end."""
    noise = {"kind": "sensor-noise", "sd_m": 0.01, "until_step": 61}
    walk = {**WALK, "steps": 60}
    for path, body in (
        ("/trainings", {**walk, "disturbances": [noise]}),
        ("/races", {**walk, "disturbances": [noise], "lanes": [GREEDY]}),
        ("/what-if", {**walk, "disturbances": [noise]}),
    ):
        words = "until_step must be at most 60, the end of this run, not 61"
        refused(api.call("POST", path, json=body), 422, words)
    run = api.until(api.train(steps=60, pace=0.1), lambda now: now["state"] == "running")
    refused(disturb(api, run, noise), 422, "until_step must be at most 60")
    api.stop(run)


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ({"disturbances": [{**LIMP, "at_step": 50}]}, "at_step must be from 0 to 49"),
        ({"disturbances": [{**LIMP, "at_step": 9, "until_step": 9}]}, "must be over at_step, 9"),
        ({"disturbances": [{**LIMP, "at_step": 9, "until_step": 3}]}, "must be over at_step, 9"),
        ({"disturbances": [{**LIMP, "until_step": 51}]}, "until_step must be at most 50"),
        ({"disturbances": [LIMP, {"kind": "lost", "legs": [4]}]}, "contradict each other"),
        ({"disturbances": [{"kind": "limp", "legs": [7]}]}, "there is no leg 7"),
        ({"disturbances": [{"kind": "slope", "degrees": 80}]}, "from 0 to 30"),
        ({"disturbances": {"kind": "slope"}}, "a list of at most 20"),
        ({"world": "moon"}, "choose one of: flat, slope"),
        ({"simulator": "kinematic", "world": "slope"}, "knows no slope"),
        ({"lanes": [{**GREEDY, "plans_with": "hope"}]}, "world, or start, or nominal"),
        (
            {"lanes": [{"agent": "q-learning", "training": {}, "plans_with": "world"}]},
            "q-learning plans with no simulator",
        ),
    ],
)
def test_a_race_in_an_impossible_world_is_refused(
    api: Api, body: dict[str, Any], words: str
) -> None:
    refused(api.call("POST", "/races", json={**MUJOCO, **body}), 422, words)


@pytest.fixture(scope="module")
def original(api: Api) -> dict[str, Any]:
    lanes = [GREEDY, {**GREEDY, "plans_with": "world"}]
    return api.finished(api.start("/races", {**MUJOCO, "lanes": lanes, "steps": 16}))


def distances(api: Api, race: dict[str, Any]) -> list[list[float]]:
    recording = api.get(f"/races/{race['id']}/recording")
    return [[step["distance_m"] for step in lane["steps"]] for lane in recording["lanes"]]


def test_a_branch_is_the_same_race_to_the_last_bit_until_its_step(
    api: Api, original: dict[str, Any]
) -> None:
    branch = {"race_id": original["id"], "step": 8}
    race = api.finished(api.start("/races", {"branch_from": branch, "disturbances": [LIMP]}))

    assert race["config"]["branch_from"] == branch
    for run, said in ((original, ["world", "world"]), (race, ["nominal", "world"])):
        assert [lane["plans_with"] for lane in run["config"]["lanes"]] == said
        by_default = [lane["plans_with_by_default"] for lane in run["config"]["lanes"]]
        assert by_default == [True, False]
        assert [lane["plans_with"] for lane in run["result"]["lanes"]] == said
    assert race["config"]["disturbances"] == [{"kind": "limp", "at_step": 8, "legs": [1, 4]}]
    before, after = distances(api, original), distances(api, race)
    for lane in (0, 1):
        assert after[lane][:8] == before[lane][:8]
        assert after[lane][8] != before[lane][8]
    unaware, aware = (lane[-1] for lane in after)
    assert aware > unaware + 0.02  # nobody told the first


@pytest.mark.parametrize(
    ("branch", "happens", "refusal"),
    [
        ({"step": 16}, [LIMP], (422, "must be from 0 to 15, not 16: race")),
        *(
            ({"step": step}, [LIMP], (422, "branch_from.step must be a whole number from 0 to"))
            for step in (-1, True, "5", 1.5, None, 1e9)
        ),
        ({"step": -1}, [LIMP], (422, "steps that the race has taken; at least one must be left")),
        ({"step": 16}, [LIMP], (422, "has taken 16 of 16 steps, and at least one must be left")),
        ({"step": 19_999}, [LIMP], (422, "must be from 0 to 15, not 19,999")),
        ({"step": 8}, [{**LIMP, "at_step": 7}], (422, "at_step must be at least 8")),
        ({"step": 8}, [{**LIMP, "at_step": 16}], (422, "at_step must be from 0 to 15")),
        ({"step": 8, "race_id": "nope"}, [LIMP], (404, "nope")),
        ({}, [LIMP], (422, "branch_from.step is missing; it must be a whole number from 0")),
    ],
)
def test_a_branch_where_there_is_none_is_refused(
    api: Api, original: dict[str, Any], branch: Any, happens: Any, refusal: tuple[int, str]
) -> None:
    body = {"branch_from": {"race_id": original["id"], **branch}, "disturbances": happens}
    refused(api.call("POST", "/races", json=body), *refusal)


def test_members_that_a_branch_does_not_have_are_refused_as_one_error(
    api: Api, original: dict[str, Any]
) -> None:
    """A body may have a hundred thousand of them."""
    unknown = {f"unknown{number}": 0 for number in range(1000)}
    branch = {"race_id": original["id"], "step": 1, **unknown}
    answer = api.call("POST", "/races", json={"branch_from": branch, "disturbances": [LIMP]})
    assert answer.status_code == 422
    [error] = answer.json()["errors"]
    assert error["field"] == "branch_from"
    assert "unknown0" in error["detail"]
    assert "race_id, step" in error["detail"]


def test_only_races_branch(api: Api, trained: dict[str, Any]) -> None:
    body = {"branch_from": {"race_id": trained["id"], "step": 1}, "disturbances": [LIMP]}
    refused(api.call("POST", "/races", json=body), 422, "is not a race")
    other = {**body, "gait": WALK["gait"]}
    refused(api.call("POST", "/races", json=other), 422, "unknown field 'gait'")


def test_a_race_that_has_not_come_so_far_cannot_branch_there(api: Api) -> None:
    race = api.race(lanes=[GREEDY], steps=20_000)
    now = api.until(race, lambda now: now["progress"]["done"] > 3)
    api.tell(race, "stop")
    body = {"branch_from": {"race_id": race["id"], "step": 19_999}}
    refused(api.call("POST", "/races", json=body), 422, "steps, and at least one must be left")
    assert now["progress"]["done"] < 19_999


def test_results_tell_where_robots_fell_and_face(api: Api) -> None:
    lost = {"kind": "lost", "legs": [1, 2, 3], "at_step": 2}
    body = {**MUJOCO, "lanes": [GREEDY], "disturbances": [lost], "steps": 6}
    (lane,) = api.finished(api.start("/races", body))["result"]["lanes"]

    assert 2 <= lane["fell_at_step"] < 6
    assert -180 <= lane["heading_deg"] <= 180


def test_a_searcher_knows_the_start_unless_its_lane_says_otherwise() -> None:
    """Legs 1 and 4 are limp: a plan for the whole robot treads on the spot."""
    modes = (None, "start", "world", "nominal")
    lanes = tuple(lane_config("greedy", plans_with=how) for how in modes)
    config = RaceConfig(
        gait=WALK["gait"],
        robot=HASTY,
        lanes=lanes,
        steps=12,
        world=world([LIMP]),
        branch_from=Branch("x", 3),
    )
    *_, recorded = record_race(build_walkers(config, [None] * 4), config, lambda: 0.0)
    knows_start, same, knows_world, unaware = (lane.distance_m for lane in recorded)

    assert config.world == named_world("limp-pair")
    assert knows_start == same == knows_world > unaware + 0.03


def test_options_tell_what_can_happen(api: Api) -> None:
    options = api.get("/options")
    worlds = {world_option["name"]: world_option for world_option in options["worlds"]}
    assert worlds["flat"]["disturbances"] == []
    assert worlds["limp-pair"]["disturbances"] == [{**LIMP, "at_step": 0}]
    assert worlds["slope"]["description"] == "The track rises by 8°."

    kinds = {disturbance["name"]: disturbance for disturbance in options["disturbances"]}
    assert kinds["limp"]["simulators"] == ["mujoco"]
    assert kinds["sensor-noise"]["simulators"] == ["mujoco", "kinematic"]
    legs = kinds["limp"]["fields"]["legs"]
    assert (legs["is_list"], legs["is_whole"], legs["minimum"], legs["maximum"]) == (
        True, True, 1, 12
    )  # fmt: skip
    slope = kinds["slope"]["fields"]
    assert list(slope) == ["degrees", "direction_deg", "at_step", "until_step"]
    assert [field["is_required"] for field in slope.values()] == [True, False, False, False]
    assert (slope["degrees"]["maximum"], slope["degrees"]["unit"]) == (30, "°")
    assert (kinds["slope"]["size"], kinds["slope"]["nothing"]) == ("degrees", 0)
    assert (kinds["weak"]["size"], kinds["weak"]["nothing"]) == ("torque_share", 1)
    assert (kinds["friction"]["size"], kinds["friction"]["nothing"]) == ("value", "friction")
    assert (kinds["limp"]["size"], kinds["patch"]["nothing"]) == (None, None)
    built = {robot["name"]: robot["built"] for robot in options["robots"]}
    assert (built["stiff"], built["slippery"]) == ({"friction": 1}, {"friction": 0.1})
    stuck = kinds["stuck"]["fields"]
    assert stuck["joint"]["choices"] == ["coxa", "femur", "tibia"]
    assert (stuck["angle_rad"]["minimum"], stuck["angle_rad"]["maximum"]) == (-7, 7)
    assert stuck["angle_rad"]["ranges"]["field"] == "joint"
    assert stuck["angle_rad"]["ranges"]["ranges"]["tibia"] == [-2.8, 0]
    assert slope["degrees"]["ranges"] is None

    searching = {agent["name"] for agent in options["agents"] if agent["searches"]}
    assert {"greedy", "beam", "mcts"} <= searching
    assert not searching & {"q-learning", "linear-model"}
    knows = options["settings"]["plans_with"]
    assert knows["choices"] == ["world", "start", "nominal"]
    assert knows["choice_titles"] == ["true model", "model of the start", "nominal model"]
    assert options["settings"]["observation"]["choices"] == ["measured", "commanded", "planned"]
    assert stuck["joint"]["choice_titles"] == stuck["joint"]["choices"]


def test_options_are_compressed_once_and_revalidated(api: Api) -> None:
    first = api.call("GET", "/options", headers={"Accept-Encoding": "gzip"})
    assert first.headers["content-encoding"] == "gzip"
    conditional = {"Accept-Encoding": "gzip", "If-None-Match": first.headers["etag"]}
    assert api.call("GET", "/options", headers=conditional).status_code == 304
    plain = api.call("GET", "/options", headers={"Accept-Encoding": "identity"})
    assert plain.json() == first.json()


@pytest.mark.promises
def test_robot_differs_from_its_design_by_the_tolerance(api: Api) -> None:
    body = {**MUJOCO, "agent": "q-learning", "steps": 2, "evaluate_every": 0, "world": "limp-pair"}
    plain, built, again = (
        api.finished(api.start("/trainings", {**body, "seed": 3, **extra}))
        for extra in ({}, {"tolerance": 0.1}, {"tolerance": 0.1})
    )

    assert (plain["config"]["tolerance"], built["config"]["tolerance"]) == (0.0, 0.1)
    assert built["result"] == again["result"]
    assert built["result"]["distance_m"] != plain["result"]["distance_m"]
    best_m = best_known_m(WalkingProblem(gait=MUJOCO["gait"], world=named_world("limp-pair")))
    assert best_m is not None
    assert plain["result"]["best_known_m"] == built["result"]["best_known_m"] == best_m
    assert api.get(f"/trainings/{plain['id']}/curve")["best_known_m"] == best_m
