"""Start, watch and stop a race over REST, by a client that a generator made.

    curl -o openapi.json http://127.0.0.1:8000/openapi.json
    openapi-python-client generate --path openapi.json --output-path client
    PYTHONPATH=client python generated_client.py http://127.0.0.1:8000

Needs `openapi-python-client`, and a running `hexapods serve`.
"""

import sys
import time

from racing_hexapods_client import AuthenticatedClient, Client
from racing_hexapods_client.api.races import get_race, start_race, stop_race
from racing_hexapods_client.models import GreedyLane, LookAheadLane, ProblemDetails, RaceBody
from racing_hexapods_client.models.race_body_simulator import RaceBodySimulator


def main(address: str, token: str | None = None) -> None:
    """Race greedy against look-ahead, and stop the race after its first steps."""
    client = AuthenticatedClient(address, token) if token else Client(address)
    body = RaceBody(
        gait="left-right-origin",
        simulator=RaceBodySimulator.KINEMATIC,
        lanes=[GreedyLane(agent="greedy"), LookAheadLane(agent="look-ahead")],
        steps=5000,
    )
    race = start_race.sync(client=client, body=body)
    if race is None or isinstance(race, ProblemDetails):
        sys.exit(f"refused: {race}")
    print(f"started {race.id}")
    while race.state.value in ("queued", "running") and race.progress.done == 0:
        time.sleep(0.1)
        race = get_race.sync(race.id, client=client)
    print(f"{race.state.value}: {race.progress.done} of {race.progress.total} steps")
    stop_race.sync(race.id, client=client)
    while race.state.value in ("queued", "running"):
        time.sleep(0.1)
        race = get_race.sync(race.id, client=client)
    print(f"{race.state.value} after {race.progress.done} steps")


if __name__ == "__main__":
    main(*sys.argv[1:])
