"""`hexapods race`: race agents side by side, timed under three clocks."""

import json
import re
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, NamedTuple

from cyclopts import Parameter

from app.cli.exit_codes import FAILED
from app.cli.options import WALKING_PROBLEM, AsJson, Data, Gait, KeepOptions, WalkOptions, read_gait
from app.cli.setting_options import DeclaredOptions
from app.cli.terminal import progress, show_lanes
from app.settings import Settings, read_settings
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
_NOT_KEPT = KeepOptions()


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
    keeping: KeepOptions = _NOT_KEPT,
    data: Data = None,
    as_json: AsJson = False,
    **settings: Annotated[
        Any,
        DeclaredOptions(declared_fields(WalkingProblem), group=WALKING_PROBLEM),
        DeclaredOptions(_DECLARED, ("steps", "seed")),
    ],
) -> int:
    """Race agents side by side, timed under three clocks.

    Exit code 1: a lane failed. Exit code 130: Ctrl-C.

    Args:
        observation: how the agents of lanes read the state that have no table and say nothing
            else; a trained lane uses its table's
        clock: clock to show

    Raises:
        HexapodError: if the options are not valid.
    """
    keeping.check()
    entrants = [_lane(text, observation) for text in lane]
    options = {"gait": read_gait(gait), **walk.fields(), **settings}
    if keeping.keep:
        kept_in = read_settings(data=data)
        return _keep(entrants, options, kept_in, clock, name=keeping.name, as_json=as_json)
    with progress() as bar:
        steps = settings.get("steps", _DECLARED["steps"].default)
        task = bar.add_task("racing", total=len(lane) * steps)
        done = races.race(
            [entrant.lane for entrant in entrants], on_step=lambda: bar.advance(task), **options
        )
    if as_json:
        print(json.dumps(_as_json(done)))
    else:
        show_lanes(done, clock)
    return FAILED if done.failed else 0


class _Entrant(NamedTuple):
    """A lane, with the path of its table; None without one."""

    lane: races.Lane
    table: str | None


def _keep(
    entrants: Sequence[_Entrant],
    options: Mapping[str, Any],
    kept_in: Settings,
    clock: Clock,
    *,
    name: str | None,
    as_json: bool,
) -> int:
    """Race, and keep the race in the data folder, with a progress bar."""
    # Imported here, as the database modules would slow the start of other commands.
    from app.cli import kept_runs  # noqa: PLC0415

    kept_runs.check_keepable(entrant.lane.config.agent for entrant in entrants)
    config = races.config_of([entrant.lane for entrant in entrants], options)
    tables = [entrant.table for entrant in entrants]
    kept, done = kept_runs.keep_race(kept_in, config, name=name, tables=tables)
    if done is None:
        return kept.report_unfinished()
    if as_json:
        print(json.dumps({"id": kept.id, "name": kept.progress.name, **_as_json(done)}))
    else:
        show_lanes(done, clock)
        kept.print_where()
    return FAILED if done.failed else 0


def _as_json(done: races.Race) -> dict[str, Any]:
    return {
        "config": to_json(done.config),
        "result": to_json(done.result),
        "gait": _gaits(done),
        "best_known_m": done.best_known_m,
        "recording_sha256": done.recording_sha256,
    }


def _lane(text: str, observation: Any) -> _Entrant:
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
    return _Entrant(races.lane(agent, table=table, **settings), path or None)


def _gaits(done: races.Race) -> list[dict[str, Any] | None]:
    """Return the gait of each lane in single numbers; see `hexapods.runs.gait_analysis`."""
    walks = [
        walk_of_lane(recording, done.config, done.config.world) for recording in done.recording
    ]
    window = window_of(walks, None, None)
    return [gait_summary(gait_figures(walk, *window)) for walk in walks]
