"""`hexapods race`: agents side by side, timed under three clocks."""

import argparse
import json
import time
from collections.abc import Sequence
from typing import Any

from app.agents.registry import needs_practice
from app.assembly import build_walkers
from app.cli.files import read_table
from app.cli.options import (
    CommandParser,
    add_observation,
    add_settings,
    add_walk_options,
    walk_from,
)
from app.cli.terminal import progress, show_lanes
from app.domain.errors import InvalidInput
from app.domain.settings import declared_fields
from app.runs.clocks import CLOCKS, check_clock
from app.runs.config import LaneConfig, RaceConfig, as_json
from app.runs.racing import record_race
from app.runs.recording import LaneRecording
from app.runs.results import race_result
from app.runs.tables import Checkpoint
from app.runs.walker import Walker


def add_to(commands: "argparse._SubParsersAction[CommandParser]") -> None:
    """Add the command's parser."""
    parser = commands.add_parser("race", help="race agents", description=__doc__)
    add_walk_options(parser)
    add_observation(parser, "of lanes without a table; a trained lane uses its table's")
    parser.add_argument(
        "--lane",
        action="append",
        required=True,
        metavar="AGENT[=Q.NPZ]",
        help="once for each lane: greedy, two-step, q-learning=q.npz, my.module:Agent[=q.npz]",
    )
    add_settings(parser, declared_fields(RaceConfig), ("steps", "seed"))
    parser.add_argument("--clock", default="paper", help=f"to show: {', '.join(CLOCKS)}")
    parser.add_argument("--json", action="store_true", help="print config and result as JSON")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run a race and print its result.

    Raises:
        HexapodError: if the options are not valid.
    """
    check_clock(options.clock)
    lanes = [_lane(text, options.observation) for text in options.lane]
    config = RaceConfig(
        **walk_from(options),
        lanes=tuple(lane for lane, _ in lanes),
        steps=options.steps,
        seed=options.seed,
    )
    walkers = build_walkers(config, [table for _, table in lanes])
    result = race_result(_race(walkers, config), config.steps)
    if options.json:
        print(json.dumps({"config": as_json(config), "result": result}))
    else:
        show_lanes(result, options.clock)
    return 0


def _lane(text: str, observation: Any) -> tuple[LaneConfig, Checkpoint | None]:
    agent, _, path = text.partition("=")
    if not path:
        if needs_practice(agent):
            raise InvalidInput(
                f"a {agent} lane needs its table: --lane {agent}=q.npz "
                "(hexapods train --out q.npz makes one)"
            )
        return LaneConfig(agent=agent, observation=observation), None
    table = read_table(path)
    if table.meta["agent"] != agent:
        raise InvalidInput(f"{path} was learned by {table.meta['agent']}, not by {agent}")
    return LaneConfig(agent=agent, observation=table.meta["observation"]), table


def _race(walkers: Sequence[Walker], config: RaceConfig) -> list[LaneRecording]:
    recording: list[LaneRecording] = []
    with progress() as bar:
        task = bar.add_task("racing", total=len(walkers) * config.steps)
        for grown in record_race(walkers, config, time.perf_counter):
            recording = grown
            bar.advance(task)
    return recording
