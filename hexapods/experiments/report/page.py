"""Render the report as a self-contained HTML page: no scripts, no other files, no network."""

import json
import shlex
from collections import Counter
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined, select_autoescape
from markupsafe import Markup

from hexapods.agents.appearance import title_of
from hexapods.domain.records import to_json
from hexapods.domain.text import counted
from hexapods.experiments.claims.cases import Case, cases_of
from hexapods.experiments.config import (
    ExperimentConfig,
    by_option,
    default_agents,
    experiment_config,
)
from hexapods.experiments.formatting import listed
from hexapods.experiments.labels import gait_name
from hexapods.experiments.presets import PRESETS
from hexapods.experiments.report import figure_worlds, tables
from hexapods.experiments.report.drawing import Picture, agent_colours, inline_svg
from hexapods.experiments.report.figures import panels
from hexapods.runs.best_known import COVERAGE, DEFINITION

POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"
"""The page's Content-Security-Policy, also set by a `<meta>` element of the page."""
_FIRST = (
    "agents",
    "gaits",
    "observations",
    "robots",
    "seeds",
    "seed",
    "simulator",
    "worlds",
    "tolerance",
    "reward",
)
"""Fields whose options come first in a command, in order."""


def page(summary: Mapping[str, Any]) -> str:
    """Render the page; Jinja escapes every value, so that names cannot inject markup."""
    cases, name = cases_of(summary), summary["experiment"]
    context: Mapping[str, Any] = {
        "summary": summary,
        "title": PRESETS[name].heading,
        "policy": POLICY,
        "lead": _lead(summary),
        "in_short": _claims_summary(summary["claims"]),
        "figures": [(heading, inlined_figures(group)) for heading, group in panels(summary)],
        "cases": cases,
        "agents": _agent_colours(cases),
        "world_agents": figure_worlds.colours(summary),
        "colors": agent_colours([]),
        "units": tables.UNITS,
        "about_best_known": f"{DEFINITION} {COVERAGE}",
        "has_best_known": any(one["best_known_m"] for one in summary["settings"]),
        "table1": [tables.table1(case) for case in cases] if name == "table1" else [],
        "plain_tables": [
            *(tables.curves(case) for case in cases if name == "figure4"),
            *(tables.sweep(case) for case in cases if name == "sweep"),
            *tables.worlds(summary),
        ],
        "versus": tables.versus(summary) if summary["versus"] else None,
        "story": [
            {"heading": section["heading"], "paragraphs": section["text"].split("\n")}
            for section in summary["story"]
        ],
        "command": command(summary["config"]),
    }
    return environment().get_template("report.html").render(context)


def command(config: Mapping[str, Any]) -> str:
    """Return the shell command of an experiment: its seeds and all options other than defaults."""
    name, chosen = config["experiment"], by_option(config)
    given: dict[str, Any] = {"simulator": config["simulator"]}
    if "agents" in PRESETS[name].fields:
        given["agents"] = tuple(config["agents"])
    usual = {"agents": list(default_agents(PRESETS[name])), "simulator": ExperimentConfig.simulator}
    defaults = by_option(to_json(experiment_config(name, given))) | usual
    arguments = ["hexapods", *PRESETS[name].command.split()]
    for field in dict.fromkeys((*_FIRST, *chosen)):
        if field in chosen and (field in ("seeds", "seed") or chosen[field] != defaults.get(field)):
            option = ExperimentConfig.option_of(field)
            arguments += [part for text in option_values(chosen[field]) for part in (option, text)]
    return shlex.join(arguments)


def option_values(value: Any) -> list[str]:
    """Return an option's arguments: one comma-separated list, or each alone if one is JSON."""
    values = value if isinstance(value, list) else [value]
    plain = [_as_word(one) for one in values]
    if None not in plain:
        return [",".join(map(str, plain))]
    return [one or json.dumps(value) for one, value in zip(plain, values, strict=True)]


def _as_word(value: Any) -> str | None:
    """Return a value as a plain word, or None if it can only be written as JSON."""
    if isinstance(value, Mapping):
        return str(value["preset"]) if set(value) == {"preset"} else None
    return str(value)


def _lead(summary: Mapping[str, Any]) -> str:
    """Describe in one line which trials were run."""
    config, trials = summary["config"], summary["trials"]
    gaits = [g if isinstance(g, str) else None for g in config["gaits"]]
    if not gaits:
        named = "each robot in the gait that suits it"
    elif len(gaits) <= 2 and all(gaits):
        named = listed(gait_name(g) for g in gaits if g)
    else:
        named = counted(len(gaits), "gait")
    simulator = "MuJoCo" if config["simulator"] == "mujoco" else "the kinematic simulator"
    done = f"{trials['done']:,} of {trials['total']:,} trials"
    return (
        f"{counted(config['seeds'], 'seed')} a setting, {named}, "
        f"{counted(len(config['observations']), 'reading')} of the state, "
        f"{counted(len(config['robots']), 'robot')}, in {simulator}; {done}."
    )


def _claims_summary(claims: Sequence[Mapping[str, Any]]) -> str:
    """Count the claims by verdict, in one sentence."""
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


def _agent_colours(cases: Sequence[Case]) -> list[tuple[str, str]]:
    """Return name and colour of each learning agent, for the legend."""
    agents = dict.fromkeys(one["agent"] for case in cases for one in case.curves)
    colour_by_agent = agent_colours(list(agents))
    return [(title_of(agent), colour_by_agent[agent]) for agent in agents]


def inlined_figures(group: Sequence[Picture]) -> list[dict[str, Any]]:
    """Return pictures as the templates embed them."""
    return [
        # The SVG is generated by us, and Matplotlib escapes the names in it.
        {
            "title": one.title,
            "alt": one.alt,
            "name": one.name,
            "svg": Markup(inline_svg(one.figure, one.name)),  # noqa: S704
        }
        for one in group
    ]


@lru_cache(maxsize=1)
def environment() -> Environment:
    """Return the environment of the report's templates, which escapes every value."""
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent / "templates"),
        autoescape=select_autoescape(),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["cost"] = _cost
    environment.filters["capitalize"] = lambda text: text[:1].upper() + text[1:]
    return environment


def _cost(cost: Mapping[str, Any]) -> str:
    """Format the known parts of the cost: times, throughput and workers."""
    parts = (
        ("wall_s", "{:,.0f} s from start to end"),
        ("compute_s", "{:,.0f} s of computing"),
        ("trials_per_s", "{:.2f} trials a second"),
    )
    formatted = [words.format(cost[k]) for k, words in parts if cost.get(k) is not None]
    if cost.get("workers") is not None:
        formatted.append(counted(cost["workers"], "worker"))
    return ", ".join(formatted)
