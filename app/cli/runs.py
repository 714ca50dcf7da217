"""`hexapods runs`: the runs in the data folder, with or without a running server.

Reading never disturbs the server. Changes go through the running server; without one, this
command makes them itself.
"""

import json
import sys
from collections.abc import Mapping
from datetime import datetime
from typing import Annotated, cast
from urllib.parse import quote

from cyclopts import App, Parameter

from app.cli.commands import load, verb_paths
from app.cli.options import AsJson, Data, RunId, WholeNumber
from app.cli.server_client import call_server
from app.cli.stored_runs import find_run, open_for_reading, open_for_writing
from app.cli.terminal import show_lanes, show_table
from app.events.run_view import run_view
from app.settings import read_settings
from app.storage.json_text import json_text
from app.storage.run import SORTS, AnyRun, DamagedRun, Run, Sort, State
from app.storage.run_kind import WALKS, added_kind, run_kinds
from hexapods.agents.appearance import title_of
from hexapods.domain.errors import InvalidInput
from hexapods.races import Race
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.results import RaceResult, TrainingResult

_LIMIT = 50
_TITLES: Mapping[Sort, str] = {
    "newest": "Newest first",
    "oldest": "Oldest first",
    "name": "By name",
    "distance": "Longest distance first",
}
_HEAD = ("run", "kind", "state", "steps", "result", "began", "name")


def runs() -> App:
    """Return the command with its verbs, also those that features add."""
    app = App(help="List, show and delete runs, with or without a running server.")
    for name, verb in (("list", _list), ("show", _show), ("delete", _delete)):
        app.command(verb, name=name)
    for path in verb_paths("runs"):
        load(path)(app)
    return app


def _list(
    *,
    kind: Annotated[str | None, Parameter(choices=tuple(run_kinds()))] = None,
    state: State | None = None,
    tag: str | None = None,
    search: str | None = None,
    sort: Sort = SORTS[0],
    limit: WholeNumber = _LIMIT,
    data: Data = None,
    as_json: AsJson = False,
) -> int:
    """List runs.

    Args:
        kind: only runs of this kind
        state: only runs in this state
        tag: only runs with this tag
        search: only runs with this text in their name, id, tags or notes
        sort: order
        limit: at most so many
    """
    if limit < 1:
        raise InvalidInput(f"--limit must be at least 1, not {limit}")
    with open_for_reading(read_settings(data=data)) as store:
        page = store.list(
            kind,
            state,
            limit,
            search=search,
            tag=tag,
            sort=sort,
        )
    if as_json:
        items = [run_view(run) for run in page.items]
        print(json_text({"items": items, "next_cursor": page.next_cursor}))
        return 0
    if not page.items:
        print("There are no such runs.")
        return 0
    rows = [_row(run) for run in page.items]
    if sys.stdout.isatty():
        show_table(_TITLES[sort], _HEAD, rows, text=(1, 2, 4, 6))
    else:
        print("\n".join("\t".join(row) for row in rows))
    if page.next_cursor is not None:
        print(f"There are more; --limit {2 * limit} shows more of them.")
    return 0


def _row(run: AnyRun) -> tuple[str, ...]:
    if isinstance(run, DamagedRun):
        began = "" if run.created_at is None else _local(run.created_at)
        return (run.id, run.kind or "", "damaged", "", "", began, run.damaged)
    done = f"{run.total:,}" if run.done == run.total else f"{run.done:,} of {run.total:,}"
    if (counted := run_kinds()[run.kind].counted) != "steps":
        done += f" {counted}"
    began = _local(run.started_at or run.created_at)
    return (run.id, run.kind, run.state, done, _outcome(run), began, run.name)


def _local(moment: datetime) -> str:
    return moment.astimezone().strftime("%Y-%m-%d %H:%M")


def _outcome(run: Run) -> str:
    """Summarise the result of a run in one or two words."""
    result = run.result
    if isinstance(result, TrainingResult):
        return "" if result.distance_m is None else f"{result.distance_m:.2f} m"
    if isinstance(result, RaceResult):
        return ", ".join(
            title_of(lane_result.agent)
            for lane_result in result.lanes
            if lane_result.clocks.paper.rank == 1
        )
    kind = added_kind(run.kind)
    return "" if kind is None or result is None else kind.outcome(result)


def _show(run_id: RunId, /, *, data: Data = None, as_json: AsJson = False) -> int:
    """Show one run in full."""
    with open_for_reading(read_settings(data=data)) as store:
        run = find_run(store, run_id)
        curve = store.curves.get(run.id)
    view = run_view(run)
    if as_json:
        print(json_text({**view, "curve": list(curve)}))
        return 0
    if "damaged" in view:
        for name, value in view.items():
            print(f"{name:>18}  {value or ''}")
        return 0
    progress, result = view.pop("progress"), view.pop("result")
    counted = run_kinds()[run.kind].counted if isinstance(run, Run) else "steps"
    if result:
        view.pop("best_known_m", None)  # it stands under the lanes
    view[counted] = f"{progress['done']:,} of {progress['total']:,}"
    view["evaluations"] = len(curve)
    for name, value in view.items():
        if value:
            print(f"{name:>18}  {value if isinstance(value, str) else json.dumps(value)}")
    if isinstance(run, Run) and isinstance(run.result, RaceResult):
        show_lanes(Race(cast(RaceConfig, run.config), (), run.result), "paper")
    elif result:
        print(f"{'result':>18}  {json.dumps(result)}")
    return 0


def _delete(run_id: RunId, /, *, data: Data = None, as_json: AsJson = False) -> int:
    """Delete an ended run and all its files."""
    from app.storage.server_lock import FolderInUse  # noqa: PLC0415

    settings = read_settings(data=data)
    # Look the run up first: an unknown id needs no lock and no server.
    with open_for_reading(settings) as reader:
        run = find_run(reader, run_id)
    try:
        with open_for_writing(settings) as store:
            store.delete(run.id)
    except FolderInUse:
        kind = run.kind or WALKS[0]
        call_server(settings, "DELETE", f"api/v1/{kind}s/{quote(run.id, safe='')}")
    message = f"Deleted {run.kind or 'run'} {run.id}."
    print(json.dumps({"deleted": run.id}) if as_json else message)
    return 0
