"""`hexapods race`: race agents side by side, timed under three clocks."""

import argparse
import json
import re
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
from app.domain.errors import InvalidInput, UnknownName
from app.domain.settings import declared_fields
from app.domain.world import check_ends
from app.runs.best_known import best_known_in_race_m
from app.runs.clocks import CLOCKS, check_clock
from app.runs.config import agent_settings
from app.runs.config_json import as_json
from app.runs.gait_analysis import gait_figures, gait_summary, window_of
from app.runs.lane import LaneConfig, lane_config, observation_of
from app.runs.race_config import RaceConfig
from app.runs.racing import record_race
from app.runs.recorded_walk import walk_of_lane
from app.runs.recording import LaneRecording
from app.runs.results import lane_details, race_result
from app.runs.tables import Checkpoint
from app.runs.walker import Walker

_SETTING = re.compile(r",\s*([^\W\d]\w*)=")
"""A setting in a lane, `,name=`; its value ends before the next."""


def add_to(commands: "argparse._SubParsersAction[CommandParser]") -> None:
    """Add the command's parser."""
    parser = commands.add_parser("race", help="race agents", description=__doc__)
    add_walk_options(parser)
    add_observation(
        parser, "of lanes without a table that say nothing else; a trained lane uses its table's"
    )
    parser.add_argument(
        "--lane",
        action="append",
        required=True,
        metavar="AGENT[=Q.NPZ][,SETTING=VALUE]",
        help="agent of a lane, repeat for each lane: greedy, look-ahead,depth=3, q-learning=q.npz, "
        "q-learning=q.npz,keep_learning=true, greedy,plans_with=nominal, "
        "sarsa,keep_learning=true,observation=planned, my.module:Agent[=q.npz]; "
        f"plans_with: {declared_fields(LaneConfig)['plans_with'].about.help}",
    )
    add_settings(parser, declared_fields(RaceConfig), ("steps", "seed"))
    parser.add_argument("--clock", default="paper", help=f"clock to show: {', '.join(CLOCKS)}")
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
    check_ends(config.world.disturbances, config.steps)
    walkers = build_walkers(config, [table for _, table in lanes])
    lanes_recorded = _race(walkers, config)
    result = race_result(lanes_recorded, config.steps)
    for lane, details in zip(result["lanes"], lane_details(lanes_recorded, config), strict=True):
        lane.update(details)
    if options.json:
        best_m = best_known_in_race_m(config)
        shown = {"config": as_json(config), "result": result, "best_known_m": best_m}
        print(json.dumps({**shown, "gait": _gaits(lanes_recorded, config)}))
    else:
        show_lanes(config, result, options.clock)
    return 0


def _lane(text: str, observation: Any) -> tuple[LaneConfig, Checkpoint | None]:
    """Parse `AGENT[=Q.NPZ][,NAME=VALUE]…`; any other comma belongs to the path."""
    head, *given = _SETTING.split(text)
    agent, _, path = head.partition("=")
    values = dict(zip(given[::2], given[1::2], strict=True))
    declared = {**declared_fields(LaneConfig), **agent_settings(agent)}
    for name in values:
        if name not in declared:
            raise UnknownName(f"setting of a {agent} lane", name, declared)
    settings: dict[str, Any] = {name: declared[name].parse(value) for name, value in values.items()}
    table = read_table(path) if path else None
    if table is not None and table.meta["agent"] != agent:
        raise InvalidInput(f"{path} was learned by {table.meta['agent']}, not by {agent}")
    practised = None if table is None else table.meta["observation"]
    settings["observation"] = observation_of(settings.get("observation"), practised, observation)
    lane = lane_config(agent, has_training=table is not None, **settings)
    if needs_practice(agent) and table is None and not lane.keep_learning:
        raise InvalidInput(
            f"a {agent} lane needs its table: --lane {agent}=q.npz (hexapods train --out q.npz "
            f"makes one), or learns in the race: --lane {agent},keep_learning=true"
        )
    return lane, table


def _gaits(lanes: Sequence[LaneRecording], config: RaceConfig) -> list[dict[str, Any] | None]:
    """Return the gait of each lane in single numbers; see `app.runs.gait_analysis`."""
    walks = [walk_of_lane(lane, config, config.world) for lane in lanes]
    window = window_of(walks, None, None)
    return [gait_summary(gait_figures(walk, *window)) for walk in walks]


def _race(walkers: Sequence[Walker], config: RaceConfig) -> list[LaneRecording]:
    recording: list[LaneRecording] = []
    with progress() as bar:
        task = bar.add_task("racing", total=len(walkers) * config.steps)
        for grown in record_race(walkers, config, time.perf_counter):
            recording = grown
            bar.advance(task)
    return recording
