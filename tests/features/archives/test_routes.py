"""Export and import of runs over REST."""

from app.api.policy import policies
from app.api.work import DOWNLOAD
from tests.api.calls import Api, refused


def test_several_runs_are_exported_and_taken_in_again(api: Api) -> None:
    options = {"steps": 10, "evaluate_every": 0}
    runs = [api.finished(api.train(name=f"Heron {n}", **options)) for n in range(2)]
    live = api.slow_training(name="Heron, live")
    query = "&".join(f"id={run['id']}" for run in runs)
    exported = api.call("GET", f"/runs/export?{query}")
    assert exported.status_code == 200
    assert exported.headers["content-disposition"] == 'attachment; filename="2-runs.zip"'
    refused(api.call("GET", f"/runs/export?{query}&id={live['id']}"), 409, "stop it first")
    refused(api.call("GET", f"/runs/export?{query}&id=none"), 404, "none")
    api.stop(live)
    assert api.call("DELETE", f"/runs?{query}").json()["kept"] == []

    events = api.client.app.state.services.bus.subscribe(names={"run"})  # type: ignore[attr-defined]
    taken = api.call("POST", "/runs/import", content=exported.content)
    assert taken.status_code == 201
    assert taken.json()["items"] == runs
    once = {"content": exported.content, "headers": {"Idempotency-Key": "taken-once"}}
    copies, again = (api.call("POST", "/runs/import", **once) for _ in range(2))
    assert copies.json() == again.json()
    assert len({run["id"] for run in [*runs, *copies.json()["items"]]}) == 4
    refused(api.call("POST", "/runs/import", **{**once, "content": b"PK"}), 422, "another request")
    api.call("DELETE", f"/runs?id={copies.json()['items'][0]['id']}")
    refused(api.call("POST", "/runs/import", **once), 410, "was deleted; send a new key")
    assert {event.run_id for event in events.drain()} >= {run["id"] for run in runs}
    refused(api.call("POST", "/runs/import", content=b"PK"), 422, "no archive of a run")
    refused(api.call("POST", "/runs/import", content=b""), 422, "end the .zip file")


def test_archives_have_the_slots_of_downloads(api: Api) -> None:
    of_routes = policies(api.client.app)  # type: ignore[arg-type]
    assert of_routes["get", "/api/v1/runs/export"].work == DOWNLOAD
    assert of_routes["get", "/api/v1/races/{run_id}/export"].work == DOWNLOAD
