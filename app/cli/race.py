"""`hexapods race`: race agents side by side, timed under three clocks."""

import json
import re
from typing import Annotated, Any

from cyclopts import Parameter

from app.cli.exit_codes import FAILED
from app.cli.options import WALKING_PROBLEM, AsJson, Gait, WalkOptions, read_gait
from app.cli.setting_options import DeclaredOptions
from app.cli.terminal import progress, show_lanes
from hexapods import races
from hexapods.agents.registry import keeps_learning, needs_practice
from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.gait import DEFAULT_GAIT
from hexapods.domain.observation import Observation
from hexapods.domain.records import to_json
from hexapods.domain.settings import declared_fields
from hexapods.runs.clocks import Clock
from hexapods.runs.config import WalkingProblem, agent_settings
from hexapods.runs.gait_analysis import gait_figures, gait_summary, window_of
from hexapods.runs.lane import LaneConfig, observation_of
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.recorded_walk import walk_of_lane
from hexapods.trainings import read_table

_SETTING = re.compile(r",\s*([^\W\d]\w*)=")
"""A setting in a lane, `,name=`; its value ends before the next."""
_DECLARED = declared_fields(RaceConfig)
_WALK = WalkOptions()


def race(
    *,
    gait: Gait = DEFAULT_GAIT,
    walk: WalkOptions = _WALK,
    observation: Observation = "measured",
    lane: Annotated[
        tuple[str, ...],
        Parameter(
            metavar="AGENT[=Q.NPZ][,SETTING=VALUE]",
            help="agent of a lane, repeat for each lane: greedy, look-ahead,depth=3, "
            "q-learning=q.npz, q-learning=q.npz,keep_learning=true, greedy,plans_with=nominal, "
            "sarsa,keep_learning=true,observation=planned, my.module:Agent[=q.npz]; "
            f"plans_with: {declared_fields(LaneConfig)['plans_with'].about.help}",
        ),
    ],
    clock: Clock = "paper",
    as_json: AsJson = False,
    **settings: Annotated[
        Any,
        DeclaredOptions(declared_fields(WalkingProblem), group=WALKING_PROBLEM),
        DeclaredOptions(_DECLARED, ("steps", "seed")),
    ],
) -> int:
    """Race agents side by side, timed under three clocks.

    The exit code is 1 if a lane failed.

    Args:
        observation: how the agents of lanes read the state that have no table and say nothing
            else; a trained lane uses its table's
        clock: clock to show

    Raises:
        HexapodError: if the options are not valid.
    """
    lanes = [_lane(text, observation) for text in lane]
    with progress() as bar:
        steps = settings.get("steps", _DECLARED["steps"].default)
        task = bar.add_task("racing", total=len(lanes) * steps)
        done = races.race(
            lanes,
            on_step=lambda: bar.advance(task),
            gait=read_gait(gait),
            **walk.fields(),
            **settings,
        )
    if as_json:
        shown = {
            "config": to_json(done.config),
            "result": to_json(done.result),
            "gait": _gaits(done),
            "best_known_m": done.best_known_m,
            "recording_sha256": done.recording_sha256,
        }
        print(json.dumps(shown))
    else:
        show_lanes(done, clock)
    return FAILED if done.failed else 0


def _lane(text: str, observation: Any) -> races.Lane:
    """Parse `AGENT[=Q.NPZ][,NAME=VALUE]…`; any other comma belongs to the path."""
    head, *setting_texts = _SETTING.split(text)
    agent, _, path = head.partition("=")
    values = dict(zip(setting_texts[::2], setting_texts[1::2], strict=True))
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
    return races.lane(agent, table=table, **settings)


def _gaits(done: races.Race) -> list[dict[str, Any] | None]:
    """Return the gait of each lane in single numbers; see `hexapods.runs.gait_analysis`."""
    walks = [
        walk_of_lane(recording, done.config, done.config.world) for recording in done.recording
    ]
    window = window_of(walks, None, None)
    return [gait_summary(gait_figures(walk, *window)) for walk in walks]
