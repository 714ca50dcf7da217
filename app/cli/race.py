"""`hexapods race`: race agents side by side, timed under three clocks."""

import argparse
import json
import re
from typing import Any

from app.cli.exit_codes import FAILED
from app.cli.options import (
    CommandParser,
    add_observation,
    add_settings,
    add_walk_options,
    walk_from,
)
from app.cli.terminal import progress, show_lanes
from hexapods.agents.registry import keeps_learning, needs_practice
from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.records import to_json
from hexapods.domain.settings import declared_fields
from hexapods.races import Lane, Race, lane, race
from hexapods.runs.clocks import CLOCKS, check_clock
from hexapods.runs.config import agent_settings
from hexapods.runs.gait_analysis import gait_figures, gait_summary, window_of
from hexapods.runs.lane import LaneConfig, observation_of
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.recorded_walk import walk_of_lane
from hexapods.trainings import read_table

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
    """Run a race, print its result, and return the exit code: 1 if a lane failed.

    Raises:
        HexapodError: if the options are not valid.
    """
    check_clock(options.clock)
    lanes = [_lane(text, options.observation) for text in options.lane]
    with progress() as bar:
        task = bar.add_task("racing", total=len(lanes) * options.steps)
        done = race(
            lanes,
            steps=options.steps,
            seed=options.seed,
            on_step=lambda: bar.advance(task),
            **walk_from(options),
        )
    if options.json:
        shown = {
            "config": to_json(done.config),
            "result": to_json(done.result),
            "gait": _gaits(done),
            "best_known_m": done.best_known_m,
            "recording_sha256": done.recording_sha256,
        }
        print(json.dumps(shown))
    else:
        show_lanes(done, options.clock)
    return FAILED if done.failed else 0


def _lane(text: str, observation: Any) -> Lane:
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
    if table is not None and table.config.agent != agent:
        raise InvalidInput(f"{path} was learned by {table.config.agent}, not by {agent}")
    practised = None if table is None else table.config.observation
    settings["observation"] = observation_of(settings.get("observation"), practised, observation)
    learns = settings.get("keep_learning", keeps_learning(agent))
    if needs_practice(agent) and table is None and not learns:
        raise InvalidInput(
            f"a {agent} lane needs its table: --lane {agent}=q.npz (hexapods train --out q.npz "
            f"makes one), or learns in the race: --lane {agent},keep_learning=true"
        )
    return lane(agent, table=table, **settings)


def _gaits(done: Race) -> list[dict[str, Any] | None]:
    """Return the gait of each lane in single numbers; see `hexapods.runs.gait_analysis`."""
    walks = [walk_of_lane(one, done.config, done.config.world) for one in done.recording]
    window = window_of(walks, None, None)
    return [gait_summary(gait_figures(walk, *window)) for walk in walks]
