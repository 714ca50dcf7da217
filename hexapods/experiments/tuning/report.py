"""The report of a tuning as files: the page, all trials as CSV, and the summary."""

import csv
import json
import shlex
from collections.abc import Iterator, Mapping, Sequence
from io import StringIO
from typing import Any

from hexapods.agents.appearance import title_of
from hexapods.domain.text import counted, metres, text_cell
from hexapods.experiments.config import REPORT, SUMMARY, TRIALS_TABLE
from hexapods.experiments.formatting import number
from hexapods.experiments.labels import gait_name, world_name
from hexapods.experiments.plan import Trial
from hexapods.experiments.progress import Progress
from hexapods.experiments.report.drawing import (
    INK,
    Picture,
    agent_colours,
    figure,
    figure_style,
    style_axes,
)
from hexapods.experiments.report.page import POLICY, environment, inlined_figures, option_values
from hexapods.experiments.report.tables import Cell, Table, agent_name, cell, share_cell
from hexapods.experiments.tuning.config import OBJECTIVES, TuningConfig, config_json
from hexapods.experiments.tuning.ranges import declared_range
from hexapods.experiments.tuning.summary import gains
from hexapods.experiments.tuning.tuning import Tuning, objective_m
from hexapods.runs.best_known import DEFINITION
from hexapods.runs.config import agent_settings

BEST = 10
"""Number of the best candidates in the page's table; the summary has all."""
_PAST_END = 1.1
"""Factor by which an axis goes past the range that was searched."""
_COLUMNS = ("Distance", "Mean over practice", "Of greedy", "Of best known", "Seeds")
_TRIAL_FIELDS = ("seed_number", "seed", "practised_steps", "distance_m", "mean_m", "failure")
_FIELDS = (
    "gaits",
    "observations",
    "robots",
    "worlds",
    "simulator",
    "divisions",
    "grid_side_m",
    "tolerance",
    "reward",
    "steps",
    "candidates",
    "search_seeds",
    "held_out_seeds",
    "seed",
    "objective",
)
"""Fields whose options a command has, in order."""
_ALWAYS = ("steps", "candidates", "search_seeds", "held_out_seeds", "seed")


def tuning_files(
    tuning: Tuning, progress: Progress, summary: Mapping[str, Any]
) -> Iterator[tuple[str, bytes]]:
    """Yield name and bytes of each file; the same outcomes give the same bytes, cost aside.

    Args:
        tuning: the tuning, which is complete.
        progress: the outcomes of its trials.
        summary: as by `summarise_tuning`.
    """
    yield SUMMARY, (json.dumps(summary, allow_nan=False) + "\n").encode()
    yield TRIALS_TABLE, _trials_csv(tuning, progress)
    yield REPORT, tuning_page(summary).encode()


def tuning_page(summary: Mapping[str, Any]) -> str:
    """Render the page; Jinja escapes every value, so that names cannot inject markup."""
    search, config = summary["search"], summary["config"]
    with figure_style():
        pictures = [_scatter(one, summary) for one in search["ranges"]]
    context = {
        "summary": summary,
        "title": f"{title_of(summary['agent'])}, tuned",
        "policy": POLICY,
        "lead": _lead(config),
        "objective": OBJECTIVES[config["objective"]],
        "about_best_known": DEFINITION,
        "held_out": _held_out_table(summary),
        "gains": gains(summary),
        "figures": inlined_figures(pictures),
        "candidates": _candidate_table(summary),
        "refused": [one for one in search["candidates"] if one["reason"]],
        "colors": agent_colours([]),
        "command": command(config),
    }
    return environment().get_template("tuning.html").render(context)


def command(config: Mapping[str, Any]) -> str:
    """Return the shell command of a tuning, with all options other than defaults."""
    agent, *beside = config["agents"]
    defaults = config_json(TuningConfig(gaits=("",), agents=(agent,)))
    arguments = ["hexapods", "tune", agent]
    for field in _FIELDS:
        value = config[field]
        if field in _ALWAYS or value != defaults[field]:
            option = TuningConfig.option_of(field)
            arguments += [option, *option_values(value)]
    usual = [str(one) for one in map(declared_range, agent_settings(agent).values()) if one]
    for text in config["ranges"]:
        if text not in usual:
            arguments += ["--range", text]
    names = [text.partition("=")[0] for text in config["ranges"]]
    if not {text.partition("=")[0] for text in usual} <= set(names):
        arguments += ["--settings", ",".join(names)]
    return shlex.join([*arguments, *(["--beside", ",".join(beside)] if beside else [])])


def held_out_name(one: Mapping[str, Any]) -> str:
    """Return the name of an entry of the held-out seeds: `Q-learning, tuned`."""
    roles = {"tuned": ", tuned", "defaults": ", defaults"}
    return agent_name(one) + roles.get(one["name"], "")


def _lead(config: Mapping[str, Any]) -> str:
    (gait,), (world,) = config["gaits"], config["worlds"]
    simulator = "MuJoCo" if config["simulator"] == "mujoco" else "the kinematic simulator"
    place = gait_name(gait) if isinstance(gait, str) else "own gait"
    return (
        f"{counted(config['candidates'], 'candidate')}, each a combination of settings, on "
        f"{counted(config['search_seeds'], 'seed')}, then the best and the defaults on "
        f"{counted(config['held_out_seeds'], 'held-out seed')}; "
        f"{config['steps'][0]:,} steps of practice, {place}, {world_name(world)}, in {simulator}."
    )


def _held_out_table(summary: Mapping[str, Any]) -> Table:
    entries = sorted(summary["held_out"], key=lambda one: -float(one["distance"]["iqm"]))
    best_m = next((one["best_known_m"] for one in entries), None)

    def row(one: Mapping[str, Any]) -> tuple[str, Sequence[Cell]]:
        return held_out_name(one), [
            cell(one["distance"]),
            cell(one["mean_m"]),
            share_cell(one["of_greedy"]),
            share_cell(one["of_best_known"]),
            (f"{one['n']:,}", ""),
        ]

    label = "" if best_m is None else f"best known {metres(best_m)}"
    return Table(label, _COLUMNS, [row(one) for one in entries])


def _candidate_table(summary: Mapping[str, Any]) -> Table:
    ranges, tried = summary["search"]["ranges"], _tried(summary)
    best = sorted(tried, key=lambda one: (-one["value_m"], one["number"]))[:BEST]
    shown = best + [one for one in tried if one["number"] == 0 and one not in best]

    def row(one: Mapping[str, Any]) -> tuple[str, Sequence[Cell]]:
        values = [(_value_text(one["values"][own["name"]]), "") for own in ranges]
        name = "Defaults" if one["number"] == 0 else f"Candidate {one['number']}"
        return name, [*values, (number(one["value_m"], 3), "")]

    return Table(
        "the best candidates of the search, and the defaults",
        [*(one["title"] for one in ranges), "In the search"],
        [row(one) for one in shown],
        len(tried) - len(shown),
    )


def _scatter(one: Mapping[str, Any], summary: Mapping[str, Any]) -> Picture:
    """Draw the objective of every candidate over the values of one setting."""
    name, tried, number_of_best = one["name"], _tried(summary), summary["search"]["best"]
    default = [each for each in tried if each["number"] == 0]
    (best,) = (each for each in tried if each["number"] == number_of_best)
    colour = agent_colours([summary["agent"]])[summary["agent"]]
    places = {value: place for place, value in enumerate(one["choices"])}
    fig = figure(3.4, 2.6)
    ax = fig.subplots()

    def draw(candidates: Sequence[Mapping[str, Any]], **style: Any) -> None:
        values = [each["values"][name] for each in candidates]
        ax.plot(
            [places.get(value, value) for value in values],
            [each["value_m"] for each in candidates],
            ls="",
            **style,
        )

    draw(tried, marker="o", ms=5, mew=0, color=colour, alpha=0.7)
    draw(default, marker="D", ms=6, mew=0, color=INK)
    draw([best], marker="o", ms=11, mew=1.4, mec=INK, mfc="none", clip_on=False)
    if places:
        ax.set_xticks(list(places.values()), [_value_text(value) for value in places])
        ax.set_xlim(-0.5, len(places) - 0.5)
    elif one["is_logarithmic"]:
        ax.set_xscale("log")
        ax.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
        ax.xaxis.set_minor_formatter(lambda *_: "")
        ax.set_xlim(one["low"] / _PAST_END, one["high"] * _PAST_END)
    else:
        margin = (_PAST_END - 1) / 2 * (one["high"] - one["low"])
        ax.set_xlim(one["low"] - margin, one["high"] + margin)
    ax.set_ylim(bottom=min(0.0, ax.get_ylim()[0]))
    ax.set_xlabel(one["symbol"] or one["title"])
    ax.set_ylabel("distance [m]")
    style_axes(ax, "y")
    alt = (
        f"{one['title']} of {counted(len(tried), 'candidate')}; the default is "
        f"{_value_text(one['default'])}, of the best {_value_text(best['values'][name])}."
    )
    return Picture(f"tuning-{name}", one["title"], alt, fig)


def _tried(summary: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    return [one for one in summary["search"]["candidates"] if one["value_m"] is not None]


def _value_text(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def _trials_csv(tuning: Tuning, progress: Progress) -> bytes:
    """Return all trials, one row each: those of the search by candidate, then the held-out ones."""
    names = [one.name for one in tuning.config.search_ranges]
    out = StringIO()
    writer = csv.writer(out)
    writer.writerow(("trial", "phase", "candidate", "agent", *names, *_TRIAL_FIELDS))
    for candidate in tuning.candidates:
        if candidate.value_m is not None:
            for trial in tuning.search_trials(candidate.values):
                writer.writerow(_row(trial, "search", candidate.number, names, progress))
    for trial in tuning.plan.trials():
        writer.writerow(_row(trial, "held-out", "", names, progress))
    return out.getvalue().encode()


def _row(
    trial: Trial, phase: str, candidate: int | str, names: Sequence[str], progress: Progress
) -> list[Any]:
    training, result = trial.config.training, progress.results.get(trial.key)
    values = [training.settings.get(name) for name in names]
    failure = progress.set_aside.get(trial.key, "") if result is None else result.failure or ""
    walked = result is not None and not result.failure
    has_curve = walked and len(trial.config.evaluations) > 1
    return [
        text_cell(trial.key),
        phase,
        candidate,
        text_cell(training.agent),
        *(text_cell(value) if isinstance(value, str) else value for value in values),
        trial.seed_number,
        training.seed,
        trial.setting.practised_steps,
        result.distances_m[-1] if result is not None and walked else None,
        objective_m("area", trial.config, result) if result is not None and has_curve else None,
        text_cell(failure),
    ]
