"""Trainings at once: `python benchmarks/many_trainings.py http://127.0.0.1:8000 --trainings 30`.

Starts trainings of one problem with different seeds on a server that runs on this machine, waits
until all have ended, prints one JSON object with the time from the first request to the last end,
and deletes them. Compare two versions in one run of both, as the machine's speed is in the figure.
"""

import argparse
import json
import sys
import time
import urllib.request
from typing import Any

_POLL_S = 0.5
"""Time between two requests, each of which costs the server what a few steps of practice do."""
_ENDED = ("finished", "failed", "stopped", "interrupted")


def main() -> int:
    """Start the trainings, wait for them, and print the time."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("server", help="its address")
    parser.add_argument("--trainings", type=int, default=30)
    parser.add_argument("--steps", type=int, default=500)
    parser.add_argument("--deadline", type=float, default=300.0, help="end after so long [s]")
    options = parser.parse_args()

    def call(method: str, path: str, body: Any = None) -> Any:
        request = urllib.request.Request(  # noqa: S310 - the user's own server
            f"{options.server.rstrip('/')}/api/v1/{path}",
            None if body is None else json.dumps(body).encode(),
            {"Content-Type": "application/json"},
            method=method,
        )
        with urllib.request.urlopen(request, timeout=30) as answer:  # noqa: S310
            return json.loads(answer.read() or "null")

    walk = {"gait": "left-right-origin", "steps": options.steps, "pace": "max"}
    began_s = time.perf_counter()
    ids = [
        call("POST", "trainings", {**walk, "seed": seed})["id"] for seed in range(options.trainings)
    ]
    states: dict[str, str] = {}
    while len(states) < len(ids):
        if time.perf_counter() - began_s > options.deadline:
            sys.exit(f"{len(ids) - len(states)} trainings have not ended in {options.deadline} s")
        time.sleep(_POLL_S)
        listed = call("GET", f"trainings?limit={len(ids)}")["items"]
        states = {run["id"]: run["state"] for run in listed if run["id"] in ids}
        states = {run_id: state for run_id, state in states.items() if state in _ENDED}
    took_s = time.perf_counter() - began_s
    for run_id in ids:
        call("DELETE", f"trainings/{run_id}")
    outcome = {state: [*states.values()].count(state) for state in {*states.values()}}
    print(json.dumps({"trainings": len(ids), "took_s": round(took_s, 2), "states": outcome}))
    return 0 if outcome == {"finished": len(ids)} else 1


if __name__ == "__main__":
    sys.exit(main())
