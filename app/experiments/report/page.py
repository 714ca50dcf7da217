"""The report as one page that needs nothing beside it: no scripts, no other files, no network."""

import json
import shlex
from collections import Counter
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined, select_autoescape
from markupsafe import Markup

from app.experiments.claims.cases import Case, cases
from app.experiments.config import GRID, as_json, experiment_config
from app.experiments.formatting import agent_name, counted, gait_name, listed
from app.experiments.report import tables
from app.experiments.report.drawing import Picture, colours, inlined
from app.experiments.report.figures import panels

TITLES: Mapping[str, str] = {
    "table1": "Table 1, many times over",
    "figure4": "Figure 4, many times over",
    "sweep": "A sweep",
}
POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"
"""The page's Content-Security-Policy; it says so itself too."""
_OPTIONS = {
    "agents": "agent",
    "gaits": "gait",
    "observations": "observation",
    "robots": "robot",
    **{name: name.replace("_", "-") for name in ("seeds", "seed", "simulator", *GRID)},
}


def page(summary: Mapping[str, Any]) -> str:
    """The whole page as HTML; every name in it is text."""
    places = cases(summary)
    shown: Mapping[str, Any] = {
        "summary": summary,
        "title": TITLES[summary["experiment"]],
        "policy": POLICY,
        "lead": _lead(summary),
        "in_short": _in_short(summary["claims"]),
        "figures": [(heading, _inlined(group)) for heading, group in panels(summary)],
        "cases": places,
        "agents": _agents(places),
        "units": tables.UNITS,
        "table1": _of("table1", tables.table1, summary, places),
        "plain_tables": _of("figure4", tables.curves, summary, places)
        + _of("sweep", tables.sweep, summary, places),
        "versus": tables.versus(summary) if summary["versus"] else None,
        "story": [
            {"heading": told["heading"], "paragraphs": told["text"].split("\n")}
            for told in summary["story"]
        ],
        "command": command(summary["config"]),
    }
    return _environment().get_template("report.html").render(shown)


def command(config: Mapping[str, Any]) -> str:
    """What to type for the same experiment: all that differs from its defaults, and the seeds."""
    name = config["experiment"]
    usual = as_json(experiment_config(name, {}))
    said = ["hexapods", *(["sweep"] if name == "sweep" else ["experiment", name])]
    for field, option in _OPTIONS.items():
        if field in ("seeds", "seed") or config[field] != usual[field]:
            said += [part for text in _texts(config[field]) for part in (f"--{option}", text)]
    return shlex.join(said)


def _texts(value: Any) -> list[str]:
    """What follows an option: values with commas between; one that is JSON stands alone."""
    values = value if isinstance(value, list) else [value]
    plain = [_plain(one) for one in values]
    if None not in plain:
        return [",".join(map(str, plain))]
    return [one or json.dumps(value) for one, value in zip(plain, values, strict=True)]


def _plain(value: Any) -> str | None:
    """A value as it is typed; None if it has to be JSON."""
    if isinstance(value, Mapping):
        return str(value["preset"]) if set(value) == {"preset"} else None
    return str(value)


def _of(
    experiment: str, table: Any, summary: Mapping[str, Any], places: Sequence[Case]
) -> list[Any]:
    return [table(case) for case in places] if summary["experiment"] == experiment else []


def _lead(summary: Mapping[str, Any]) -> str:
    """What was run, in one line."""
    config, trials = summary["config"], summary["trials"]
    gaits = [g if isinstance(g, str) else None for g in config["gaits"]]
    named = (
        listed(gait_name(g) for g in gaits if g)
        if len(gaits) <= 2 and all(gaits)
        else counted(len(gaits), "gait")
    )
    simulator = "MuJoCo" if config["simulator"] == "mujoco" else "the kinematic simulator"
    done = f"{trials['done']:,} of {trials['total']:,} trials"
    return (
        f"{counted(config['seeds'], 'seed')} a setting, {named}, "
        f"{counted(len(config['observations']), 'reading')} of the state, "
        f"{counted(len(config['robots']), 'robot')}, in {simulator}; {done}."
    )


def _in_short(claims: Sequence[Mapping[str, Any]]) -> str:
    """How the claims came out, counted."""
    if len(claims) < 2:
        return ""
    count = Counter(claim["verdict"] for claim in claims)
    several = max(len(claim["where"]) for claim in claims) > 1
    words = {
        "holds": "{} in every case that was tried" if several else "{} here",
        "does not hold": "{} in none" if several else "{} not",
        "depends": "{} on the reading or on the robot",
        "not established": "{} open",
    }
    verbs = {
        "holds": "holds" if count["holds"] == 1 else "hold",
        "does not hold": "holds" if count["does not hold"] == 1 else "hold",
        "depends": "depends" if count["depends"] == 1 else "depend",
        "not established": "stays" if count["not established"] == 1 else "stay",
    }
    if not several:
        verbs["does not hold"] = "does" if count["does not hold"] == 1 else "do"
    parts = [words[one].format(f"{count[one]} {verbs[one]}") for one in words if count[one]]
    return f"Of {counted(len(claims), 'claim')} of the paper, {listed(parts)}."


def _agents(places: Sequence[Case]) -> list[tuple[str, str]]:
    """Who learns, and in which colour."""
    agents = dict.fromkeys(one["agent"] for case in places for one in case.curves)
    shade = colours(list(agents))
    return [(agent_name(agent), shade[agent]) for agent in agents]


def _inlined(group: Sequence[Picture]) -> list[dict[str, Any]]:
    return [
        # Our own drawing; what users named in it, matplotlib has escaped.
        {
            "title": one.title,
            "alt": one.alt,
            "name": one.name,
            "svg": Markup(inlined(one.figure, one.name)),  # noqa: S704
        }
        for one in group
    ]


@lru_cache(maxsize=1)
def _environment() -> Environment:
    made = Environment(
        loader=FileSystemLoader(Path(__file__).parent / "templates"),
        autoescape=select_autoescape(),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters["cost"] = _cost
    made.filters["capitalize"] = lambda text: text[:1].upper() + text[1:]
    return made


def _cost(cost: Mapping[str, Any]) -> str:
    """Whatever of the cost is known, in words."""
    parts = (
        ("wall_s", "{:,.0f} s from start to end"),
        ("compute_s", "{:,.0f} s of computing"),
        ("trials_per_s", "{:.2f} trials a second"),
    )
    said = [words.format(cost[k]) for k, words in parts if cost.get(k) is not None]
    if cost.get("workers") is not None:
        said.append(counted(cost["workers"], "worker"))
    return ", ".join(said)
