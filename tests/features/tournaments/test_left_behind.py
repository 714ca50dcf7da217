"""Tournaments of rooms, on a demo whose classroom is left out."""

from datetime import UTC, datetime, timedelta
from pathlib import Path

from sqlalchemy import update

from app.features.demo.settings import DemoSettings
from app.features.tournaments.tables import TOURNAMENTS
from app.settings import Settings
from tests.api.conftest import running


def test_a_demo_without_the_classroom_keeps_the_tournaments_of_rooms(tmp_path: Path) -> None:
    """It does not know which rooms there are: none is taken for left behind."""
    token = "a-token-for-tests"
    operator = {"Authorization": f"Bearer {token}"}

    def demo(*without: str) -> Settings:
        is_demo = DemoSettings(demo=True)
        return Settings(data=tmp_path, token=token, features=(is_demo,), without=without)

    with running(demo()) as api:
        code = api.call("POST", "/rooms", json={}, headers=operator).json()["code"]
        rules = {"room": code, "rules": {"gait": "tripod"}}
        opened = api.call("POST", "/tournaments", json=rules, headers=operator).json()
        database = api.client.app.state.services.store.database  # type: ignore[attr-defined]
        old = datetime.now(UTC) - timedelta(days=2)
        aged = update(TOURNAMENTS).values(created_at=old)
        database.write(lambda connection: connection.execute(aged))
    with running(demo("classroom")):
        pass
    with running(demo()) as api:
        shown = api.call("GET", f"/tournaments/{opened['id']}", headers=operator)
        assert shown.json()["room"] == code
