"""Robots with any number of legs get through all that the server answers of a run."""

from typing import Any

import pytest

from hexapods.domain.creatures import CREATURES
from hexapods.domain.gait import gait_as_json, resolve
from tests.api.calls import Api
from tests.features.needing import needs
from tests.quick_robot import QUICK_STEPS


@pytest.mark.parametrize("name", ["starfish", "centipede"])
@needs("explanations", "exports")
def test_a_creature_is_trained_raced_explained_and_exported(name: str, api: Api) -> None:
    robot = CREATURES[name].robot
    gait = resolve(CREATURES[name].gait, robot.azimuths_deg)
    walk: dict[str, Any] = {
        "gait": gait_as_json(CREATURES[name].gait),
        "robot": {"preset": name, **QUICK_STEPS},
        "simulator": "mujoco",
    }
    trained = api.finished(api.start("/trainings", {**walk, "steps": 30, "evaluate_every": 15}))
    lanes = [{"agent": "q-learning", "training_id": trained["id"]}, {"agent": "linear-model"}]
    limp = {"kind": "limp", "legs": [len(robot.legs)], "at_step": 3}
    race = api.finished(
        api.start("/races", {**walk, "lanes": lanes, "steps": 6, "disturbances": [limp]})
    )

    explained = api.get(f"/runs/{trained['id']}/explain", params={"step": 20})
    assert explained["pairs"] == [list(group) for group in gait.groups]
    table = api.get(f"/trainings/{trained['id']}/table", params={"step": 30})
    assert table["pairs"] == explained["pairs"]
    figures = api.get(f"/runs/{race['id']}/gait")["lanes"][0]["figures"]
    assert [leg["leg"] for leg in figures["legs"]] == list(range(1, len(robot.legs) + 1))
    head = api.call("GET", f"/runs/{race['id']}/trajectory").text.split("\r\n")[0]
    assert f"leg{len(robot.legs)}_tibia_rad" in head
    for path in (f"/runs/{race['id']}/mcap", f"/runs/{race['id']}/page"):
        assert api.call("GET", path).status_code == 200
    code = api.get(f"/runs/{race['id']}/code")
    assert name in str(code)
    posture = ",".join("1" * len(gait.groups))
    assert api.call("GET", f"/runs/{race['id']}/replay/posture?lane=0&cells={posture}").is_success
