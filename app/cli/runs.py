"""`hexapods runs`: the runs in the data folder, with or without a running server.

Reading never disturbs the server. Changes go through the running server; without one, this
command makes them itself.
"""

import argparse
import importlib
import json
import sys
from collections.abc import Mapping
from datetime import datetime
from typing import cast
from urllib.parse import quote

from app.cli.commands import verb_modules
from app.cli.options import CommandParser, integer
from app.cli.server_client import call_server
from app.cli.stored_runs import add_data, add_run, find_run, open_for_reading, open_for_writing
from app.cli.terminal import show_lanes, show_table
from app.events.run_view import run_view
from app.settings import read_settings
from app.storage.json_text import json_text
from app.storage.run import SORTS, STATES, AnyRun, DamagedRun, Run, Sort
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


def add_to(commands: "argparse._SubParsersAction[CommandParser]") -> None:
    """Add the command's parser."""
    parser = commands.add_parser("runs", help="list, show and delete runs", description=__doc__)
    verbs = parser.add_subparsers(dest="verb", required=True, metavar="VERB")
    listing = verbs.add_parser("list", help="list runs")
    listing.add_argument("--kind", choices=tuple(run_kinds()), help="only runs of this kind")
    listing.add_argument("--state", choices=STATES, help="only runs in this state")
    listing.add_argument("--tag", help="only runs with this tag")
    listing.add_argument(
        "--search", help="only runs with this text in their name, id, tags or notes"
    )
    listing.add_argument(
        "--sort", choices=SORTS, default=SORTS[0], help=f"order (default {SORTS[0]})"
    )
    listing.add_argument(
        "--limit", type=integer, default=_LIMIT, help=f"at most so many (default {_LIMIT})"
    )
    showing = verbs.add_parser("show", help="show one run in full")
    deleting = verbs.add_parser("delete", help="delete an ended run and all its files")
    for verb, run in ((listing, _list), (showing, _show), (deleting, _delete)):
        verb.set_defaults(run=run)
        add_data(verb)
        verb.add_argument("--json", action="store_true", help="print JSON")
    for verb in (showing, deleting):
        add_run(verb)
    for module in verb_modules("runs"):
        importlib.import_module(module).add_to(verbs)


def _list(options: argparse.Namespace) -> int:
    if options.limit < 1:
        raise InvalidInput(f"--limit must be at least 1, not {options.limit}")

    with open_for_reading(read_settings(data=options.data)) as store:
        page = store.list(
            options.kind,
            options.state,
            options.limit,
            search=options.search,
            tag=options.tag,
            sort=options.sort,
        )
    if options.json:
        items = [run_view(run) for run in page.items]
        print(json_text({"items": items, "next_cursor": page.next_cursor}))
        return 0
    if not page.items:
        print("There are no such runs.")
        return 0
    rows = [_row(run) for run in page.items]
    if sys.stdout.isatty():
        show_table(_TITLES[options.sort], _HEAD, rows, text=(1, 2, 4, 6))
    else:
        print("\n".join("\t".join(row) for row in rows))
    if page.next_cursor is not None:
        print(f"There are more; --limit {2 * options.limit} shows more of them.")
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
        return ", ".join(title_of(one.agent) for one in result.lanes if one.clocks.paper.rank == 1)
    kind = added_kind(run.kind)
    return "" if kind is None or result is None else kind.outcome(result)


def _show(options: argparse.Namespace) -> int:
    with open_for_reading(read_settings(data=options.data)) as store:
        run = find_run(store, options.run_id)
        curve = store.curves.get(run.id)
    view = run_view(run)
    if options.json:
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


def _delete(options: argparse.Namespace) -> int:
    from app.storage.server_lock import FolderInUse  # noqa: PLC0415

    settings = read_settings(data=options.data)
    # Look the run up first: an unknown id needs no lock and no server.
    with open_for_reading(settings) as reader:
        run = find_run(reader, options.run_id)
    try:
        with open_for_writing(settings) as store:
            store.delete(run.id)
    except FolderInUse:
        kind = run.kind or WALKS[0]
        call_server(settings, "DELETE", f"api/v1/{kind}s/{quote(run.id, safe='')}")
    message = f"Deleted {run.kind or 'run'} {run.id}."
    print(json.dumps({"deleted": run.id}) if options.json else message)
    return 0
