"""Robots that features name, here tournaments, are not deleted, also while these are left out."""

from pathlib import Path

import pytest

from app.settings import Settings
from tests.api.calls import refused
from tests.api.conftest import running
from tests.cli.running import in_process, refusal
from tests.features.needing import needs


@needs("tournaments")
@pytest.mark.parametrize("without", [(), ("tournaments",)], ids=["tournaments", "left out"])
def test_a_robot_that_a_feature_names_is_kept_where_that_is_left_out(
    without: tuple[str, ...], tmp_path: Path
) -> None:
    data = tmp_path / "data"
    with running(Settings(data=data)) as api:
        body = {"name": "Rex", "robot": {"preset": "dog", "femur_m": 0.09}}
        robot_id = api.call("POST", "/robots", json=body).json()["id"]
        rules = {"gait": "trot", "robots": [{"id": robot_id}]}
        assert api.call("POST", "/tournaments", json={"rules": rules}).status_code == 201
    with running(Settings(data=data, without=without)) as api:
        answer = api.call("DELETE", f"/robots/{robot_id}")
        refused(answer, 409, "tournament uses Rex", "hide it instead")
    left_out = {"HEXAPODS_WITHOUT": ",".join(without)}
    error = refusal("robots", "delete", "Rex", folder=tmp_path, run=in_process, **left_out)
    assert "a tournament uses Rex" in error


def test_a_table_that_is_missing_names_no_robot(tmp_path: Path) -> None:
    with running(Settings(data=tmp_path, without=("tournaments",))) as api:
        body = {"robot": {"preset": "dog", "femur_m": 0.09}}
        robot_id = api.call("POST", "/robots", json=body).json()["id"]
        assert api.call("DELETE", f"/robots/{robot_id}").status_code == 200
