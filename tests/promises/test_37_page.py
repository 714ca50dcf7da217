"""Promise 37: the page tells the truth: its words agree with the API after any sequence of events.

Random starts, stops, shows, deletions, waits and kills of a real server, in front of a real
browser; then the stage, the scoreboard, the form and the title are compared with the API.

Promised: 200 sequences. Here one, of two races and a kill; in full by `make soak`.
"""

import random
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx2
import pytest
from playwright.sync_api import expect

from app.storage.run import NOT_ENDED, STATES
from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving
from tests.promises.length import at_length
from tests.timeouts import LONG_S

SEEDS = at_length((326,), range(200))
"""One for each sequence; the gate's has a race, another with its practice, a stop and a kill."""
EVENTS = at_length(5, 6)
WEIGHTS = {
    "race": 4,
    "train": 2,
    "both": 2,
    "stop": 4,
    "resume": 2,
    "show": 3,
    "end": 3,
    "delete": 1,
    "kill": 1,
}
BODY = {"gait": "left-right-origin", "simulator": "kinematic"}
RACE = {**BODY, "lanes": [{"agent": "greedy"}, {"agent": "random-walk"}]}
ACTIVE: set[str] = {*NOT_ENDED}
EARLY_ENDS: dict[str, str] = {
    state: state.title() for state in {*STATES} - NOT_ENDED - {"finished"}
}


class Visit:
    """A page of a server that is driven by random events."""

    def __init__(self, dashboard: Dashboard, data: Path, chance: random.Random) -> None:
        self._dashboard, self._data, self._chance = dashboard, data, chance
        self._server = Serving(data)
        dashboard.open(self._server.link(depth="try", tab="board"))

    def close(self) -> None:
        self._server.stop()

    def drive(self) -> list[str]:
        """Carry out random events; return their names."""
        names = self._chance.choices(list(WEIGHTS), list(WEIGHTS.values()), k=EVENTS)
        for name in names:
            getattr(self, name)()
            self._dashboard.page.wait_for_timeout(self._chance.uniform(0, 1500))
        return names

    def race(self) -> None:
        """Start a race that takes a moment, or one that takes long."""
        steps = self._chance.choice([5, 2000])
        self._send("POST", "/races", json={**RACE, "steps": steps})

    def train(self) -> None:
        steps, pace = self._chance.choice([(20, "max"), (1000, 8)])
        self._send("POST", "/trainings", json={**BODY, "steps": steps, "pace": pace})

    def both(self) -> None:
        """Start a race that waits for a practice of its own."""
        practice = {"steps": 1000, "pace": 8}
        lanes = [{"agent": "q-learning", "training": practice}, {"agent": "greedy"}]
        self._send("POST", "/races", json={**RACE, "lanes": lanes, "steps": 5})

    def resume(self) -> None:
        """Resume a run that ended early."""
        if ended := [run for run in self._runs() if run["state"] in EARLY_ENDS]:
            run = self._chance.choice(ended)
            self._send("POST", f"/{run['kind']}s/{run['id']}/resume")

    def stop(self) -> None:
        for run in self._runs():
            if run["state"] in ACTIVE:
                self._send("POST", f"/{run['kind']}s/{run['id']}/stop")
                return

    def show(self) -> None:
        if runs := self._runs():
            self._send("PUT", "/stage", json={"run_id": self._chance.choice(runs)["id"]})

    def end(self) -> None:
        """Seek to the end of what is shown."""
        self._send("PUT", "/stage", json={"time_s": 1e6, "playing": True})

    def delete(self) -> None:
        if ended := [run for run in self._runs() if run["state"] not in ACTIVE]:
            run = self._chance.choice(ended)
            self._send("DELETE", f"/{run['kind']}s/{run['id']}")

    def kill(self) -> None:
        port = self._server.port
        self._server.kill()
        self._server = Serving(self._data, port)
        expect(self._dashboard.connection).to_contain_text("connected")

    def settle(self) -> None:
        """Stop what is computed, except for what is on stage, and hold the picture."""
        on_stage = self._stage()["run_id"]
        for run in self._runs():
            if run["state"] in ACTIVE and (run["id"] != on_stage or self._chance.random() < 0.5):
                self._send("POST", f"/{run['kind']}s/{run['id']}/stop")
        self._send("PUT", "/stage", json={"playing": False})

    def mistakes(self) -> list[str]:
        """Return what the page says that is not so."""
        stage = self._stage()
        run = self._run(stage["run_id"])
        active = [active_run for active_run in self._runs() if active_run["state"] in ACTIVE]
        page = Words(self._dashboard)
        wrong = [*page.about_stage(stage, run), *page.about_form(active, run)]
        if run is None or run["kind"] == "training":
            wrong += ["a scoreboard of another run"] if page.has_board else []
        else:
            timeline = self._get(f"/races/{run['id']}/timeline?clock={stage['clock']}")
            wrong += page.about_race(stage, run, (timeline or {}).get("first_finish_s"))
        return wrong

    def _send(self, method: str, path: str, **body: Any) -> None:
        """Send a request; a state may have changed meanwhile, so that it is refused."""
        answer = httpx2.request(
            method, f"{self._server.address}api/v1{path}", timeout=LONG_S, trust_env=False, **body
        )
        assert answer.status_code < 500, answer.text

    def _get(self, path: str) -> Any:
        address = f"{self._server.address}api/v1{path}"
        answer = httpx2.get(address, timeout=LONG_S, trust_env=False)
        return answer.json() if answer.status_code == 200 else None

    def _runs(self) -> list[dict[str, Any]]:
        runs = [run for kind in ("races", "trainings") for run in self._get(f"/{kind}")["items"]]
        return sorted(runs, key=lambda run: str(run["created_at"]), reverse=True)

    def _stage(self) -> dict[str, Any]:
        stage: dict[str, Any] = self._get("/stage")
        return stage

    def _run(self, run_id: str | None) -> dict[str, Any] | None:
        return next((run for run in self._runs() if run["id"] == run_id), None)


class Words:
    """Texts that the page shows."""

    def __init__(self, dashboard: Dashboard) -> None:
        page = dashboard.page
        self._label = dashboard.shown_run.inner_text()
        self._title = page.title()
        self.has_board = dashboard.standings.count() > 0
        self._headline = self._text(dashboard.headline)
        self._rows = dashboard.rows.all_inner_texts()
        self._actions = dashboard.actions.inner_text()
        self._notes = dashboard.notes.inner_text()

    @staticmethod
    def _text(locator: Any) -> str:
        text: str = locator.inner_text() if locator.count() else ""
        return text

    def about_stage(self, stage: dict[str, Any], run: dict[str, Any] | None) -> list[str]:
        if run is None:
            return [f"label of no run: {self._label}"] if self._label != "On the start line" else []
        wrong = []
        if not self._label.startswith(run["name"]):
            wrong.append(f"label of another run: {self._label}")
        is_early = stage["ended"] and run["state"] in EARLY_ENDS and run["progress"]["done"]
        if is_early and "at step" in self._label and run["state"] not in self._label:
            wrong.append(f"label of a run that is {run['state']}: {self._label}")
        has_ended_early = stage["ended"] and run["state"] in EARLY_ENDS
        if bool(has_ended_early and run["progress"]["done"]) != ("last picture" in self._notes):
            wrong.append(f"note of a run that is {run['state']}: {self._notes!r}")
        is_busy = "Stop" in self._actions.split("\n")
        if "Go on" in self._notes and not (has_ended_early and run["can_resume"] and not is_busy):
            wrong.append(f"an offer to go on with a run that is {run['state']}")
        if has_ended_early and run["kind"] == "training" and run["progress"]["done"]:
            done, total = run["progress"]["done"], run["progress"]["total"]
            if self._headline != f"{EARLY_ENDS[run['state']]} at step {done} of {total}":
                wrong.append(f"headline of a practice that is {run['state']}: {self._headline}")
        shown_name = self._headline or self._label
        if shown_name not in self._title:
            wrong.append(f"title {self._title!r} beside {shown_name!r}")
        return wrong

    def about_form(self, active: list[dict[str, Any]], run: dict[str, Any] | None) -> list[str]:
        wrong = []
        if bool(active) != ("Stop" in self._actions.split("\n")):
            wrong.append(f"{len(active)} active runs beside {self._actions!r}")
        if not active and re.search(r"Practising|Simulating|Racing…", self._actions):
            wrong.append(f"work that is none: {self._actions!r}")
        # By ids: what is computed goes on between two answers.
        is_shown = run is not None and any(active_run["id"] == run["id"] for active_run in active)
        if active and not is_shown and "shown ▸" in self._actions:
            wrong.append(f"a picture of other work: {self._actions!r}")
        return wrong

    def about_race(
        self, stage: dict[str, Any], race: dict[str, Any], time_out_s: float | None
    ) -> list[str]:
        if not self.has_board:
            return [] if not stage["ended"] or not race["progress"]["done"] else ["no scoreboard"]
        wrong = []
        end = EARLY_ENDS.get(race["state"])
        figures = [
            lane["clocks"][stage["clock"]] for lane in (race["result"] or {}).get("lanes", [])
        ]
        is_ranked = bool(figures) and all(figure["rank"] for figure in figures)
        if stage["ended"] and end and not is_ranked:
            if not self._headline.startswith(f"{end} at step"):
                wrong.append(f"headline of a race that is {race['state']}: {self._headline}")
            wrong += [f"a rank: {row}" for row in self._rows if not row.startswith("–")]
        elif stage["ended"] and race["state"] == "finished":
            if not re.search(r" wins | tie$", self._headline):
                wrong.append(f"headline of a finished race: {self._headline}")
            ranks = sorted(int(row.split()[0]) for row in self._rows)
            if ranks != sorted(figure["rank"] for figure in figures):
                wrong.append(f"ranks {ranks} for {figures}")
        elif not stage["ended"] and re.search("Stopped|Interrupted|Failed", self._headline):
            wrong.append(f"an end before the end: {self._headline}")
        is_timed_out = time_out_s is not None and stage["time_s"] >= time_out_s - 0.01
        if re.search(" wins | tie$", self._headline) and not is_timed_out:
            wrong.append(f"an outcome before time-out: {self._headline}")
        return wrong


@pytest.mark.timeout(at_length(600, 3 * 3600))
def test_page_agrees_with_the_api_after_any_sequence(dashboard: Dashboard, tmp_path: Path) -> None:
    for seed in SEEDS:
        visit = Visit(dashboard, tmp_path / str(seed), random.Random(seed))
        try:
            names = visit.drive()
            visit.settle()
            eventually_right(dashboard, visit.mistakes, f"sequence {seed}: {names}")
        finally:
            visit.close()
            dashboard.page.goto("about:blank")
            dashboard.complaints.clear()


def eventually_right(
    dashboard: Dashboard, mistakes: Callable[[], list[str]], sequence: str
) -> None:
    """Wait until the page has received all events, and says nothing that is not so."""
    wrong: list[str] = []
    for _ in range(40):
        dashboard.page.wait_for_timeout(250)
        wrong = mistakes()
        if not wrong:
            return
    raise AssertionError(f"{sequence}: {wrong}")
